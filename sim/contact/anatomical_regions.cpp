#include "sim/contact/anatomical_regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double tooth_mm = 3;       // distance within which a tooth names a point
constexpr double chin_half_mm = 12;  // on either side of the midline: neither left nor right

double half_width(const Case& patient) {
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  return left && right ? 0.5 * std::abs(left->x() - right->x()) : 0;
}

double midline_of(const Case& patient) {
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  if (left && right) return 0.5 * (left->x() + right->x());
  const Part* mandible = patient.find(Role::mandible);
  return mandible && !mandible->mesh.empty() ? bounding_box(mandible->mesh).center().x() : 0;
}

}  // namespace

std::optional<CoronoidTip> coronoid_tip(const Case& patient, const std::string& side) {
  if (const auto tip = patient.landmarks.find(side + "_coronoid_tip"))
    return CoronoidTip{*tip, false};
  const auto condyle = patient.landmarks.find(side + "_condyle");
  const double half = half_width(patient);
  if (!condyle || half <= 0) return std::nullopt;
  // Height of the upper border of the ramus, forward from the condyle.
  constexpr double bin_mm = 2;
  constexpr std::size_t bins = 30;
  constexpr double min_rise_mm = 2;  // of the tip above the notch
  const double middle = midline_of(patient), outward = side == "left" ? 1 : -1;
  const BodyId ramus = side == "left" ? patient.jaw.left_condyle : patient.jaw.right_condyle;
  std::array<std::optional<Vector3d>, bins> top;
  for (const auto& part : patient.parts) {
    if (part.body != ramus || !collides(part.role) || is_teeth(part.role)) continue;
    for (const auto& p : part.mesh.vertices) {
      const double forward = condyle->y() - p.y();
      if (forward < 0 || outward * (p.x() - middle) < 0.6 * half) continue;
      const auto bin = static_cast<std::size_t>(forward / bin_mm);
      if (bin < bins && (!top[bin] || p.z() > top[bin]->z())) top[bin] = p;
    }
  }
  // The notch: lower than the border before it, and the tip after it is higher.
  std::optional<Vector3d> notch, tip;
  for (const auto& p : top) {
    if (!p) continue;
    if (!notch || p->z() < notch->z()) {
      if (tip && tip->z() > notch->z() + min_rise_mm) break;
      notch = p;
      tip.reset();
    } else if (!tip || p->z() > tip->z()) {
      tip = p;
    }
  }
  if (!tip || tip->z() < notch->z() + min_rise_mm) return std::nullopt;
  return CoronoidTip{*tip, true};
}

AnatomicalRegions::AnatomicalRegions(const Case& patient)
    : patient_(patient), midline_mm_(midline_of(patient)) {
  add_anchors();
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const auto& part = patient.parts[i];
    if (!part.teeth.empty() && !part.mesh.empty())
      arches_.try_emplace(static_cast<int>(i), Arch{TriangleTree(part.mesh), part.teeth});
  }
}

void AnatomicalRegions::add_anchors() {
  struct Known {
    const char* landmark;  // of a pair: without the side
    const char* name;
    BodyId body;
    double reach_mm;
  };
  const JawBodies& jaw = patient_.jaw;
  const BodyId mandible = jaw.lower_arch, cranium = jaw.upper_arch;
  const std::array paired = {
      Known{"condyle", "condyle", mandible, 13}, Known{"condylion", "condyle", mandible, 8},
      Known{"sigmoid_notch", "notch of the ramus", mandible, 8},
      Known{"gonion", "angle of the mandible", mandible, 14},
      Known{"mental_foramen", "mental foramen", mandible, 6},
      // The condyle lies in its fossa at rest.
      Known{"condyle", "joint fossa", cranium, 14},
      Known{"eminence_crest", "articular eminence", cranium, 9},
      Known{"zygion", "zygomatic arch", cranium, 20}, Known{"malar", "zygomatic bone", cranium, 18},
      Known{"zygomaxillare", "zygomatic bone", cranium, 12},
      Known{"mastoidale", "mastoid process", cranium, 14}};
  const std::array single = {Known{"pogonion", "chin", mandible, 14},
                             Known{"menton", "chin", mandible, 12}};
  const auto add = [&](const Known& known, const std::string& side) {
    if (const auto p = patient_.landmarks.find((side.empty() ? "" : side + "_") + known.landmark))
      anchors_.push_back(
          {(side.empty() ? "" : side + " ") + known.name, known.body, *p, known.reach_mm});
  };
  for (const std::string side : {"left", "right"}) {
    for (const auto& known : paired) add(known, side);
    if (const auto tip = coronoid_tip(patient_, side))
      anchors_.push_back({side + " coronoid process",
                          side == "left" ? jaw.left_condyle : jaw.right_condyle, tip->point, 13});
  }
  for (const auto& known : single) add(known, "");
}

int AnatomicalRegions::tooth_at(int part, const Vector3d& p) const {
  const auto arch = arches_.find(part);
  if (arch == arches_.end()) return 0;
  const int triangle = arch->second.tree.nearest(p, tooth_mm).triangle;
  for (const auto& tooth : arch->second.teeth)
    if (triangle >= tooth.first_triangle && triangle < tooth.first_triangle + tooth.triangle_count)
      return tooth.fdi;
  return 0;
}

std::string AnatomicalRegions::side_of(const Vector3d& p) const {
  return p.x() > midline_mm_ ? "left" : "right";
}

/// Region of a point without a landmark nearby: by its forward and outward position between the
/// condyles and the incisors.
std::string AnatomicalRegions::by_shape(const Part& part, const Vector3d& p) const {
  const auto left = patient_.landmarks.find("left_condyle"),
             right = patient_.landmarks.find("right_condyle");
  const bool lower = part.body != patient_.jaw.upper_arch;
  const auto incisor =
      patient_.landmarks.find(lower ? "lower_incisal_point" : "upper_incisal_point");
  if (!left || !right || !incisor) return "";
  const double back = 0.5 * (left->y() + right->y());
  if (back - incisor->y() < 20) return "";
  const double forward = (back - p.y()) / (back - incisor->y());  // 0 condyles, 1 incisors
  const double outward = std::abs(p.x() - midline_mm_);
  const std::string side = side_of(p);
  if (is_teeth(part.role)) {
    const std::string jaw = lower ? "lower" : "upper";
    return forward > 0.85 ? jaw + " front teeth" : side + " " + jaw + " back teeth";
  }
  if (lower) {
    if (forward < 0.45) return side + " ramus";
    return outward < chin_half_mm ? "chin" : side + " body of the mandible";
  }
  if (forward > 0.1 && outward > 0.75 * half_width(patient_))
    return side + " zygomatic bone or arch";
  // The back teeth are posterior of the middle, but low; the skull base is as high as the condyles.
  const double high = 0.5 * (left->z() + right->z());
  const bool low = 2 * (high - p.z()) > high - incisor->z();
  if (forward > 0.45 || (low && forward > 0.15))
    return outward < chin_half_mm ? "front of the upper jaw" : side + " half of the upper jaw";
  return outward < chin_half_mm ? "skull base" : side + " half of the skull base";
}

std::string AnatomicalRegions::name(int part, const Vector3d& p_rest) const {
  const Part& of = patient_.parts[static_cast<std::size_t>(part)];
  if (const int fdi = tooth_at(part, p_rest)) return fmt::format("tooth {}", fdi);
  if (patient_.bodies.roams(of.body)) return of.name;
  if (!is_teeth(of.role)) {
    const Anchor* nearest = nullptr;
    double least = 1;  // fraction of the reach
    for (const auto& anchor : anchors_) {
      const double ratio = (anchor.point - p_rest).norm() / anchor.reach_mm;
      if (anchor.body != of.body || ratio >= least) continue;
      least = ratio;
      nearest = &anchor;
    }
    if (nearest) return nearest->name;
  }
  const std::string name = by_shape(of, p_rest);
  return name.empty() ? of.name : name;
}

std::string join_regions(const std::string& a, const std::string& b) {
  const std::string tooth = "tooth ";
  if (a.starts_with(tooth) && b.starts_with(tooth))
    return "teeth " + a.substr(tooth.size()) + " and " + b.substr(tooth.size());
  return a + " and " + b;
}

}  // namespace condyle
