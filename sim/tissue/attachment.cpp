#include "sim/tissue/attachment.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace condyle {
namespace {

/// Excludes the corners, where both lips merge.
bool on_lip(const CoarseSkin& skin, std::size_t v, const Column& column) {
  constexpr double lip_mm = 14;  // from the mouth's line
  const auto to = [&](int corner) {
    return (skin.mesh.vertices[corner] - skin.mesh.vertices[v]).norm();
  };
  return column.to_mouth < lip_mm &&
         column.to_mouth < std::min(to(skin.mouth.right_corner), to(skin.mouth.left_corner));
}

/// Brows and forehead glide on the skull between the temporal lines, down to the orbit's upper
/// margin and the root of the nose.
bool glides_on_forehead(const CoarseSkin& skin, const Eigen::Vector3d& p) {
  constexpr double above_eyes_mm = 9, to_temporal_line_mm = 56;
  return skin.eyes && p.z() > skin.eyes->height() + above_eyes_mm &&
         std::abs(p.x() - 0.5 * (skin.eyes->left.inner + skin.eyes->right.inner).x()) <
             to_temporal_line_mm;
}

}  // namespace

void attach_columns(const CoarseSkin& skin, const Anatomy& anatomy, const JawBodies& jaw,
                    std::vector<Column>& columns) {
  constexpr double lip_margin_mm = 9;
  constexpr double deepest_mm = 22;
  constexpr double from_bite_mm = 11;  // crowns and the edge of the gums
  // The parotid gland covers the ramus, and the skin over it glides: attachment begins at the
  // gland's anterior border and is complete in the premolar region.
  constexpr double ramus_mm = 30, to_whole_mm = 30;  // in front of the condyles
  for (std::size_t v = 0; v < columns.size(); ++v) {
    Column& c = columns[v];
    const Eigen::Vector3d& p = skin.mesh.vertices[v];
    if (c.met_globe || glides_on_forehead(skin, p)) continue;
    const double above_bite = p.z() - anatomy.bite_height(p.y());
    const bool mouth_side = c.to_mouth < lip_margin_mm;
    // The nose is supported by cartilage, which moves with the cranium.
    if (p.y() < anatomy.incisors.y() + 12 && above_bite > 22 &&
        std::abs(p.x() - anatomy.incisors.x()) < 24) {
      c.attached_to = jaw.upper_arch;
      c.cartilage = true;
      continue;
    }
    if (!c.support) continue;
    if (mouth_side || c.met_teeth || c.met_depth > deepest_mm) continue;
    const Eigen::Vector3d met = p + c.met_depth * c.inward;
    const double met_above = met.z() - anatomy.bite_height(met.y());
    // The march must hit the outer side of the bone, nearly perpendicularly.
    if (c.met_normal.dot(c.inward) > -0.35) continue;
    if (c.support == jaw.upper_arch && met_above > from_bite_mm) c.attached_to = jaw.upper_arch;
    if (c.support == jaw.lower_arch && met_above < -from_bite_mm) {
      const double before_ramus = anatomy.condyles.y() - ramus_mm - met.y();
      if (before_ramus <= 0) continue;
      c.attached_to = jaw.lower_arch;
      c.firmness = std::min(1.0, before_ramus / to_whole_mm);
    }
  }
}

void attach_as_planned(const TissuePlan& plan, const Landmarks& landmarks, const CoarseSkin& skin,
                       const std::vector<signed char>& side, const JawBodies& jaw,
                       std::vector<Column>& columns) {
  if (plan.bond == TissueBond::glued)
    for (std::size_t v = 0; v < columns.size(); ++v) {
      Column& c = columns[v];
      // A lip that overlaps the other jaw's teeth at rest still moves with its own jaw.
      const BodyId own = side[v] < 0 ? jaw.lower_arch : jaw.upper_arch;
      if (!c.attached_to && c.support) c.attached_to = on_lip(skin, v, c) ? own : *c.support;
      c.firmness = 1;
    }
  for (const auto& region : plan.attachments) {
    Eigen::Vector3d centre = region.centre;
    if (!region.landmark.empty()) {
      const auto mark = landmarks.find(region.landmark);
      if (!mark)
        throw InputError("soft tissue: there is no landmark \"" + region.landmark +
                         "\" to attach tissue around");
      centre = *mark;
    }
    const BodyId bone = region.bone == mandible_body ? jaw.lower_arch : jaw.upper_arch;
    for (std::size_t v = 0; v < columns.size(); ++v) {
      Column& c = columns[v];
      // A lip may lie on the jaw that it is not attached to.
      const bool by_support = region.attached || !c.attached_to;
      if ((by_support ? c.support : c.attached_to) != bone) continue;
      const Eigen::Vector3d met = skin.mesh.vertices[v] + c.met_depth * c.inward;
      if ((met - centre).norm() > region.radius_mm) continue;
      c.attached_to = region.attached ? c.support : std::nullopt;
      c.firmness = 1;
      c.cartilage = c.cartilage && region.attached;
    }
  }
}

}  // namespace condyle
