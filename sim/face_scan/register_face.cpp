#include "sim/face_scan/register_face.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/registration/rigid_fit.h"
#include "engine/registration/surface_fit.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Samples of a scan: every n-th vertex with its normal.
struct FaceSamples {
  std::vector<Vector3d> points, normals;
};

FaceSamples samples_of(const TriMesh& mesh, std::size_t count) {
  const std::vector<Vector3d> normals = vertex_normals(mesh);
  const std::size_t step = std::max<std::size_t>(1, mesh.vertices.size() / count);
  FaceSamples samples;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += step) {
    samples.points.push_back(mesh.vertices[i]);
    samples.normals.push_back(normals[i]);
  }
  return samples;
}

/// Those that a test of the point holds for.
template <class Test>
FaceSamples only(const FaceSamples& all, const Test& holds) {
  FaceSamples kept;
  for (std::size_t i = 0; i < all.points.size(); ++i)
    if (holds(all.points[i])) {
      kept.points.push_back(all.points[i]);
      kept.normals.push_back(all.normals[i]);
    }
  return kept;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double rms_of(std::span<const Vector3d> from, std::span<const Vector3d> to, const Pose& pose) {
  double squares = 0;
  for (std::size_t i = 0; i < from.size(); ++i) squares += (pose * from[i] - to[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, from.size())));
}

/// Standard deviation of points across the plane that fits them best, mm.
double thickness(const std::vector<Vector3d>& points) {
  Eigen::Matrix3Xd centred(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    centred.col(static_cast<Eigen::Index>(i)) = points[i];
  const Vector3d mean = centred.rowwise().mean();
  centred.colwise() -= mean;
  return centred.jacobiSvd().singularValues()[2] / std::sqrt(static_cast<double>(points.size()));
}

Vector3d mirrored(const Vector3d& p) { return {-p.x(), p.y(), p.z()}; }

/// Landmarks that are given for the scan lie on it.
void check_on_scan(const TriMesh& scan, const Landmarks& landmarks, const std::string& source) {
  constexpr double farthest_mm = 15;
  const TriangleTree tree(scan);
  const auto strays = [&](const Vector3d& axes) {
    std::vector<std::string> names;
    for (const auto& [name, p] : landmarks.points)
      if (tree.nearest(axes.cwiseProduct(p), farthest_mm).triangle < 0) names.push_back(name);
    return names;
  };
  const auto here = strays({1, 1, 1});
  if (here.empty()) return;
  const bool turned = strays({-1, -1, 1}).empty();
  throw InputError(source, here.front(),
                   fmt::format("lies more than {} mm from the scan{}", farthest_mm,
                               turned ? "; the landmarks fit in RAS coordinates: the axes of x and "
                                        "y are reversed"
                                      : "; its coordinates must be those of the scan"));
}

class FaceFitter {
 public:
  FaceFitter(const FaceScan& scan, const Landmarks& landmarks, const Case& patient,
             const std::string& source, int threads)
      : scan_(scan), patient_(patient), source_(source), threads_(threads) {
    const Part* face = patient.find(Role::face);
    if (!face) throw InputError(source, "", "cannot be registered: the case has no face");
    skin_ = face->mesh;
    weld(skin_);
    surface_.emplace(skin_);
    for (const auto& [name, p] : landmarks.points)
      if (const auto there = patient.landmarks.find(name)) {
        names_.push_back(name);
        from_.push_back(p);
        to_.push_back(*there);
      }
    if (!landmarks.points.empty()) check_on_scan(scan.mesh, landmarks, source);
  }

  FaceRegistration take() {
    const Pose start = names_.size() >= 3 ? by_landmarks() : by_axes();
    const FaceSamples all = samples_of(scan_.mesh, 6000);
    SurfaceFit fit = fit_to_surface(all.points, all.normals, *surface_, start,
                                    {.kept = 0.7, .threads = threads_});
    fit = above_the_mouth(all, fit);
    found_.X_CS = fit.X_BA;
    check_mirror(all, fit);
    measure();
    check_match();
    open_mouth(all);
    return std::move(found_);
  }

 private:
  Pose by_landmarks() {
    constexpr double least_thickness_mm = 3, worst_mm = 12;
    const auto fit = rigid_fit(from_, to_);
    if (!fit) throw InputError(source_, names_.front(), "and the other landmarks lie on one line");
    const double rms = rms_of(from_, to_, *fit);
    std::vector<Vector3d> image;
    for (const auto& p : from_) image.push_back(mirrored(p));
    const auto reflected = rigid_fit(image, to_);
    if (from_.size() >= 4 && thickness(from_) > least_thickness_mm && reflected &&
        rms_of(image, to_, *reflected) < 0.5 * rms && rms > 3)
      throw InputError(source_, "landmarks",
                       fmt::format("fit the patient's mirror image ({:.1f} mm) better than the "
                                   "patient ({:.1f} mm): left and right are exchanged",
                                   rms_of(image, to_, *reflected), rms));
    if (rms > worst_mm)
      throw InputError(source_, "landmarks",
                       fmt::format("do not fit those of the patient: {:.1f} mm remain", rms));
    for (std::size_t i = 0; i < from_.size(); ++i)
      found_.landmarks.push_back({names_[i], (*fit * from_[i] - to_[i]).norm(), 0});
    found_.fiducial_rms_mm = rms;
    return *fit;
  }

  /// The most anterior place of a face about the middle of its height: the tip of the nose.
  static Vector3d nose_tip(const std::vector<Vector3d>& points, const Eigen::Matrix3d& turn) {
    Box box;
    for (const auto& p : points) box.add(turn * p);
    const double low = box.low.z() + 0.15 * box.size().z();
    const double high = box.high.z() - 0.15 * box.size().z();
    Vector3d tip = turn * points.front();
    double front = std::numeric_limits<double>::infinity();
    for (const auto& p : points) {
      const Vector3d q = turn * p;
      if (q.z() < low || q.z() > high || q.y() >= front) continue;
      front = q.y();
      tip = q;
    }
    return tip;
  }

  /// The start whose fit leaves the least residual.
  Pose by_axes() {
    const FaceSamples few = samples_of(scan_.mesh, 1500);
    const Vector3d tip = patient_.landmarks.find("pronasale")
                             .value_or(nose_tip(skin_.vertices, Eigen::Matrix3d::Identity()));
    Pose best;
    double least = std::numeric_limits<double>::infinity();
    for (const double turn_deg : {0.0, 180.0})
      for (const auto& [tilt_deg, yaw_deg] :
           {std::pair{0.0, 0.0}, {18.0, 0.0}, {-18.0, 0.0}, {0.0, 18.0}, {0.0, -18.0}}) {
        constexpr double degree_rad = std::numbers::pi / 180;
        Pose start;
        start.R = Eigen::AngleAxisd(tilt_deg * degree_rad, Vector3d::UnitX()) *
                  Eigen::AngleAxisd((turn_deg + yaw_deg) * degree_rad, Vector3d::UnitZ());
        start.t = tip - nose_tip(few.points, start.R.toRotationMatrix());
        const SurfaceFit fit =
            fit_to_surface(few.points, few.normals, *surface_, start,
                           {.max_iterations = 40, .kept = 0.7, .threads = threads_});
        const double share = fit.pairs / (0.7 * static_cast<double>(few.points.size()));
        if (share < 0.25) continue;
        const double score = fit.rms_mm / share;
        if (score >= least) continue;
        least = score;
        best = fit.X_BA;
      }
    constexpr double worst_mm = 5;
    if (least > worst_mm)
      throw InputError(source_, "",
                       "matches the skin of the case nowhere; give at least three landmarks that "
                       "both have (--landmarks)");
    if ((best.R * -Vector3d::UnitY()).y() > 0.5)
      found_.notes.push_back(
          "face scan: turned by 180 degrees about the vertical axis, as RAS coordinates are");
    return best;
  }

  double mouth_z() const {
    constexpr double lip_height_mm = 9;
    if (const auto stomion = patient_.landmarks.find("stomion"))
      return stomion->z() + lip_height_mm;
    const Box box = bounding_box(skin_);
    return box.low.z() + 0.4 * box.size().z();
  }

  SurfaceFit above_the_mouth(const FaceSamples& all, const SurfaceFit& start) const {
    const double least_z = mouth_z();
    const FaceSamples upper =
        only(all, [&](const Vector3d& p) { return (start.X_BA * p).z() > least_z; });
    const SurfaceFit fit = fit_to_surface(upper.points, upper.normals, *surface_, start.X_BA,
                                          {.kept = 0.8, .threads = threads_});
    return fit.pairs > 0 && fit.converged ? fit : start;
  }

  /// Faces are nearly symmetric: a mirrored scan fits, but its mirror image fits better, above all
  /// where the face is uneven. Therefore nearly all pairs count.
  void check_mirror(const FaceSamples& all, const SurfaceFit& fit) {
    constexpr double far_better = 0.65, better = 0.95;
    const SurfaceFitSettings settings{.max_iterations = 60, .kept = 0.97, .threads = threads_};
    FaceSamples image;
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      image.points.push_back(mirrored(all.points[i]));
      image.normals.push_back(mirrored(all.normals[i]));
    }
    // The mirror image of the fitted scan, in the middle of the patient.
    Pose start = fit.X_BA;
    const Eigen::Matrix3d mirror = Vector3d(-1, 1, 1).asDiagonal();
    start.R = Eigen::Quaterniond(mirror * fit.X_BA.R.toRotationMatrix() * mirror);
    start.t = mirrored(fit.X_BA.t);
    const double other =
        fit_to_surface(image.points, image.normals, *surface_, start, settings).rms_mm;
    const double own =
        fit_to_surface(all.points, all.normals, *surface_, fit.X_BA, settings).rms_mm;
    if (other <= 0 || other >= better * own) return;
    const std::string fits = fmt::format(
        "its mirror image fits the skin to {:.2f} mm, the scan itself to {:.2f} mm", other, own);
    if (other < far_better * own) throw InputError(source_, "", "is mirrored: " + fits);
    found_.notes.push_back("face scan: may be mirrored: " + fits);
  }

  void measure() {
    const TriMesh& mesh = scan_.mesh;
    const std::vector<Vector3d> normals = vertex_normals(mesh);
    found_.residual_mm.assign(mesh.vertices.size(), std::nanf(""));
    parallel_for(mesh.vertices.size(), threads_, [&](std::size_t i) {
      const auto pair = surface_->find(found_.X_CS * mesh.vertices[i], found_.X_CS.R * normals[i]);
      if (pair) found_.residual_mm[i] = static_cast<float>(pair->distance);
    });
    std::vector<double> upper;
    std::size_t paired = 0;
    const double least_z = mouth_z();
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      if (std::isnan(found_.residual_mm[i])) continue;
      ++paired;
      if ((found_.X_CS * mesh.vertices[i]).z() > least_z)
        upper.push_back(std::abs(found_.residual_mm[i]));
    }
    found_.covered = static_cast<double>(paired) /
                     static_cast<double>(std::max<std::size_t>(1, mesh.vertices.size()));
    found_.median_mm = percentile(upper, 0.5);
    found_.p95_mm = percentile(upper, 0.95);
    if (found_.landmarks.empty()) return;
    for (std::size_t i = 0; i < from_.size(); ++i)
      found_.landmarks[i].target_mm = (found_.X_CS * from_[i] - to_[i]).norm();
    found_.target_rms_mm = rms_of(from_, to_, found_.X_CS);
  }

  void check_match() const {
    constexpr double worst_median_mm = 3, least_covered = 0.2;
    if (found_.median_mm <= worst_median_mm && found_.covered >= least_covered) return;
    throw InputError(source_, "",
                     fmt::format("does not match the skin of the case: {:.1f} mm remain (median), "
                                 "{:.0f} % of it has a partner; give at least three landmarks that "
                                 "both have (--landmarks)",
                                 found_.median_mm, 100 * found_.covered));
  }

  /// Registers the chin by itself: it lies lower when the mouth is more open.
  void open_mouth(const FaceSamples& all) {
    constexpr double below_mm = 12, height_mm = 60, depth_mm = 45, noted_mm = 2;
    const auto stomion = patient_.landmarks.find("stomion");
    if (!stomion) return;
    const FaceSamples chin = only(all, [&](const Vector3d& p) {
      const Vector3d q = found_.X_CS * p;
      return q.z() < stomion->z() - below_mm && q.z() > stomion->z() - height_mm &&
             q.y() < stomion->y() + depth_mm;
    });
    if (chin.points.size() < 200) return;
    SurfaceFit fit = fit_to_surface(chin.points, chin.normals, *surface_, found_.X_CS,
                                    {.kept = 0.7, .threads = threads_});
    if (fit.pairs == 0) return;
    Vector3d middle = Vector3d::Zero();
    for (const auto& p : chin.points) middle += p / static_cast<double>(chin.points.size());
    const double opening = (fit.X_BA * middle - found_.X_CS * middle).z();
    found_.mouth_opening_mm = opening;
    if (std::abs(opening) > noted_mm)
      found_.notes.push_back(fmt::format(
          "face scan: its mouth is {} open than in the case: the chin lies {:.1f} mm {}",
          opening > 0 ? "more" : "less", std::abs(opening), opening > 0 ? "lower" : "higher"));
  }

  const FaceScan& scan_;
  const Case& patient_;
  const std::string& source_;
  int threads_;
  TriMesh skin_;
  std::optional<SurfacePairs> surface_;
  std::vector<std::string> names_;
  std::vector<Vector3d> from_, to_;
  FaceRegistration found_;
};

}  // namespace

FaceRegistration register_face(const FaceScan& scan, const Landmarks& landmarks,
                               const Case& patient, const std::string& source, int threads) {
  return FaceFitter(scan, landmarks, patient, source, threads).take();
}

}  // namespace condyle
