#include "sim/tissue/attachment.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace condyle {
namespace {

/// Not beside a corner, where both lips are one.
bool on_lip(const CoarseSkin& skin, std::size_t v, const Column& column) {
  constexpr double lip_mm = 14;  // from the mouth's line
  const auto to = [&](int corner) {
    return (skin.mesh.vertices[corner] - skin.mesh.vertices[v]).norm();
  };
  return column.to_mouth < lip_mm &&
         column.to_mouth < std::min(to(skin.mouth.right_corner), to(skin.mouth.left_corner));
}

}  // namespace

void hold_columns(const CoarseSkin& skin, const Anatomy& anatomy, std::vector<Column>& columns) {
  constexpr double lip_margin_mm = 9;
  constexpr double deepest_mm = 22;
  constexpr double from_bite_mm = 11;  // crowns and the gums' edge
  // Over the ramus lies the parotid gland, and skin glides on it: the hold begins at its front edge
  // and is whole in the premolars' region.
  constexpr double ramus_mm = 30, to_whole_mm = 30;  // in front of the condyles
  for (std::size_t v = 0; v < columns.size(); ++v) {
    Column& c = columns[v];
    const Eigen::Vector3d& p = skin.mesh.vertices[v];
    const double above_bite = p.z() - anatomy.bite_height(p.y());
    const bool mouth_side = c.to_mouth < lip_margin_mm;
    // The nose stands on cartilage, which goes with the cranium.
    if (p.y() < anatomy.incisors.y() + 12 && above_bite > 22 &&
        std::abs(p.x() - anatomy.incisors.x()) < 24) {
      c.hold = Hold::cranium;
      c.cartilage = true;
      continue;
    }
    if (c.ground == Ground::none) continue;
    if (mouth_side || c.met_teeth || c.met_depth > deepest_mm) continue;
    const Eigen::Vector3d met = p + c.met_depth * c.inward;
    const double met_above = met.z() - anatomy.bite_height(met.y());
    // The march must meet the bone's outside, face on.
    if (c.met_normal.dot(c.inward) > -0.35) continue;
    if (c.ground == Ground::cranium && met_above > from_bite_mm) c.hold = Hold::cranium;
    if (c.ground == Ground::mandible && met_above < -from_bite_mm) {
      const double before_ramus = anatomy.condyles.y() - ramus_mm - met.y();
      if (before_ramus <= 0) continue;
      c.hold = Hold::mandible;
      c.firm = std::min(1.0, before_ramus / to_whole_mm);
    }
  }
}

void hold_as_planned(const TissuePlan& plan, const Landmarks& landmarks, const CoarseSkin& skin,
                     const std::vector<signed char>& side, std::vector<Column>& columns) {
  const auto hold_of = [](Ground ground) {
    return ground == Ground::mandible ? Hold::mandible : Hold::cranium;
  };
  if (plan.bond == TissueBond::glued)
    for (std::size_t v = 0; v < columns.size(); ++v) {
      Column& c = columns[v];
      // A lip that overlaps the other jaw's teeth at rest still goes with its own jaw.
      const Ground own = side[v] < 0 ? Ground::mandible : Ground::cranium;
      if (c.hold == Hold::free && c.ground != Ground::none)
        c.hold = hold_of(on_lip(skin, v, c) ? own : c.ground);
      c.firm = 1;
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
    const Ground bone = region.bone == Body::mandible ? Ground::mandible : Ground::cranium;
    for (std::size_t v = 0; v < columns.size(); ++v) {
      Column& c = columns[v];
      // A lip may lie on another jaw than holds it.
      const bool by_ground = region.attached || c.hold == Hold::free;
      if (by_ground ? c.ground != bone : c.hold != hold_of(bone)) continue;
      const Eigen::Vector3d met = skin.mesh.vertices[v] + c.met_depth * c.inward;
      if ((met - centre).norm() > region.radius_mm) continue;
      c.hold = region.attached ? hold_of(c.ground) : Hold::free;
      c.firm = 1;
      c.cartilage = c.cartilage && region.attached;
    }
  }
}

}  // namespace condyle
