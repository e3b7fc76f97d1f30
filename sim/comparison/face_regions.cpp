#include "sim/comparison/face_regions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {
namespace {

ClinicalFrame axes_of_face(const Landmarks& landmarks) {
  try {
    return clinical_frame(landmarks);
  } catch (const InputError&) {
    return {};
  }
}

/// Limits of the regions, as (left, back, up) in the patient's axes.
struct RegionLimits {
  double middle, half_mouth, half_nose, half_root;
  double sellion_up, rim_up, subnasale_up, stomion_up, b_up, menton_up;
  double nose_back, mouth_back, chin_back, cheek_back, ear_back;
};

/// Reads landmarks as components and collects those that are missing.
class LimitReader {
 public:
  LimitReader(const Landmarks& landmarks, const ClinicalFrame& axes)
      : landmarks_(landmarks), axes_(axes) {}

  Eigen::Vector3d at(const std::string& name) {
    if (const auto point = landmarks_.find(name)) return axes_.components(*point);
    missing_.push_back(name);
    return Eigen::Vector3d::Zero();
  }
  /// The first of these that the face has.
  Eigen::Vector3d any(const std::vector<std::string>& names) {
    for (const auto& name : names)
      if (const auto point = landmarks_.find(name)) return axes_.components(*point);
    missing_.push_back(fmt::format("{}", fmt::join(names, " or ")));
    return Eigen::Vector3d::Zero();
  }
  void refuse_missing() const {
    if (missing_.empty()) return;
    throw InputError(fmt::format("regions of the face need the landmark{} {}",
                                 missing_.size() == 1 ? "" : "s", fmt::join(missing_, ", ")));
  }

 private:
  const Landmarks& landmarks_;
  const ClinicalFrame& axes_;
  std::vector<std::string> missing_;
};

RegionLimits region_limits(const Landmarks& landmarks, const ClinicalFrame& axes) {
  LimitReader reader(landmarks, axes);
  const auto left_mouth = reader.at("left_cheilion"), right_mouth = reader.at("right_cheilion");
  const auto left_ala = reader.at("left_alare"), right_ala = reader.at("right_alare");
  const auto left_eye = reader.at("left_exocanthion"), right_eye = reader.at("right_exocanthion");
  const auto left_ear = reader.at("left_tragion"), right_ear = reader.at("right_tragion");
  const auto sellion = reader.any({"sellion", "soft_nasion"});
  const auto subnasale = reader.at("subnasale"), stomion = reader.at("stomion");
  const auto b_point = reader.any({"soft_b_point", "labrale_inferius"});
  const auto menton = reader.any({"soft_menton", "soft_gnathion", "soft_pogonion"});
  reader.refuse_missing();
  constexpr double beside_ala_mm = 3, half_root_mm = 12, behind_mm = 6, lid_mm = 14;
  RegionLimits limits{};
  limits.middle = 0.5 * (left_mouth.x() + right_mouth.x());
  limits.half_mouth = 0.5 * (left_mouth.x() - right_mouth.x());
  limits.half_nose = 0.5 * (left_ala.x() - right_ala.x()) + beside_ala_mm;
  limits.half_root = std::min(half_root_mm, limits.half_nose);
  limits.sellion_up = sellion.z();
  const double eyes_up = 0.5 * (left_eye.z() + right_eye.z());
  const auto left_rim = landmarks.find("left_orbitale"),
             right_rim = landmarks.find("right_orbitale");
  limits.rim_up = left_rim && right_rim
                      ? 0.5 * (axes.components(*left_rim).z() + axes.components(*right_rim).z())
                      : eyes_up - lid_mm;
  limits.subnasale_up = subnasale.z();
  limits.stomion_up = stomion.z();
  limits.b_up = b_point.z();
  limits.menton_up = menton.z();
  limits.nose_back = std::max(left_ala.y(), right_ala.y()) + behind_mm;
  limits.mouth_back = std::max(left_mouth.y(), right_mouth.y()) + behind_mm;
  limits.chin_back = std::max(limits.mouth_back, menton.y());
  limits.ear_back = 0.5 * (left_ear.y() + right_ear.y());
  limits.cheek_back = 0.5 * (0.5 * (left_eye.y() + right_eye.y()) + limits.ear_back);
  return limits;
}

/// Half the width of the nose at a height: narrow at its root.
double half_nose_at(const RegionLimits& limits, double up) {
  const double s =
      std::clamp((up - limits.subnasale_up) / (limits.sellion_up - limits.subnasale_up), 0.0, 1.0);
  return limits.half_nose + s * (limits.half_root - limits.half_nose);
}

FaceRegion region_at(const RegionLimits& limits, const Eigen::Vector3d& p) {
  const double side = p.x() - limits.middle, beside = std::abs(side), back = p.y(), up = p.z();
  if (up >= limits.subnasale_up && up < limits.sellion_up && beside <= half_nose_at(limits, up) &&
      back <= limits.nose_back)
    return FaceRegion::nose;
  if (up >= limits.rim_up) return back <= limits.ear_back ? FaceRegion::upper : FaceRegion::none;
  if (up < limits.menton_up) return FaceRegion::none;
  if (beside <= limits.half_mouth && up < limits.subnasale_up) {
    if (up < limits.b_up) return back <= limits.chin_back ? FaceRegion::chin : FaceRegion::none;
    if (back > limits.mouth_back) return FaceRegion::none;
    return up >= limits.stomion_up ? FaceRegion::upper_lip : FaceRegion::lower_lip;
  }
  if (back > limits.cheek_back) return FaceRegion::none;
  return side > 0 ? FaceRegion::left_cheek : FaceRegion::right_cheek;
}

}  // namespace

std::string region_name(FaceRegion region) {
  switch (region) {
    case FaceRegion::nose:
      return "nose";
    case FaceRegion::upper_lip:
      return "upper lip";
    case FaceRegion::lower_lip:
      return "lower lip";
    case FaceRegion::chin:
      return "chin";
    case FaceRegion::right_cheek:
      return "right cheek";
    case FaceRegion::left_cheek:
      return "left cheek";
    case FaceRegion::upper:
      return "upper face";
    case FaceRegion::none:
      break;
  }
  return "";
}

std::vector<FaceRegion> regions_of_face(const TriMesh& face, const Landmarks& landmarks,
                                        int threads) {
  const ClinicalFrame axes = axes_of_face(landmarks);
  const RegionLimits limits = region_limits(landmarks, axes);
  const TriangleTree tree(face);
  const auto normals = vertex_normals(face);
  std::vector<FaceRegion> regions(face.vertices.size(), FaceRegion::none);
  parallel_for(regions.size(), threads, [&](std::size_t i) {
    constexpr double clear_of_skin_mm = 0.05, fold_mm = 10;
    if (normals[i].isZero()) return;
    const Eigen::Vector3d& p = face.vertices[i];
    const FaceRegion region = region_at(limits, axes.components(p));
    if (region == FaceRegion::none) return;
    if (tree.ray_cast(p + clear_of_skin_mm * normals[i], normals[i], fold_mm)) return;
    regions[i] = region;
  });
  return regions;
}

const std::vector<std::string>& stable_soft_landmarks() {
  static const std::vector<std::string> names = {"soft_glabella",
                                                 "sellion",
                                                 "soft_nasion",
                                                 "soft_vertex",
                                                 "left_endocanthion",
                                                 "right_endocanthion",
                                                 "left_exocanthion",
                                                 "right_exocanthion",
                                                 "left_tragion",
                                                 "right_tragion",
                                                 "left_soft_zygion",
                                                 "right_soft_zygion",
                                                 "left_otobasion_superius",
                                                 "right_otobasion_superius"};
  return names;
}

}  // namespace condyle
