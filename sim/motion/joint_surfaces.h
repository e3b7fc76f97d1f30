#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "sim/case/case.h"

namespace condyle {

enum class JawSide { left, right };

/// The two condyles and the cranium round them: how near they come compared with rest. In place of
/// a disc, each joint keeps a gap.
class JointSurfaces {
 public:
  /// Absent when a landmark or bone is missing, or when the cranium is too far from a condyle to
  /// guide it (more than 8 mm), or touches it.
  static std::optional<JointSurfaces> find(const Case& patient);

  /// Smaller rest gap of the two sides, mm.
  double rest_gap_mm() const;
  double rest_gap_mm(JawSide side) const { return at(side).rest_gap_mm; }

  /// Smallest over the sides of (gap at X_CM - gap at rest), mm. Moving the mandible by d changes
  /// it by at most d.
  double slack_mm(const Pose& X_CM);

  /// Condyle to fossa of one side, mm. `start` makes the next query near by sooner.
  double gap_mm(JawSide side, const Pose& X_CM, TrianglePair& start) const;

 private:
  struct Side {
    CollisionMesh condyle, fossa;
    double rest_gap_mm = 0;
    TrianglePair last;  // start of the next query
  };
  const Side& at(JawSide side) const { return sides_[side == JawSide::left ? 0 : 1]; }
  std::vector<Side> sides_;
};

}  // namespace condyle
