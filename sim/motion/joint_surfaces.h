#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "sim/case/case.h"

namespace condyle {

/// The folder for box trees of surfaces of a patient; none where bones are divided, because
/// segments change with each edit of their plan.
std::filesystem::path box_tree_folder(const Case& patient);

enum class JawSide { left, right };

/// Clearance between each condyle and the cranium around it. The articular disc is represented by a
/// gap.
class JointSurfaces {
 public:
  /// Absent when a landmark or bone is missing, or when the cranium touches a condyle or is too far
  /// from it to guide it (more than 6 mm).
  static std::optional<JointSurfaces> find(const Case& patient);

  /// Smaller rest gap of the two sides, mm.
  double rest_gap_mm() const;
  double rest_gap_mm(JawSide side) const { return at(side).rest_gap_mm; }
  /// A hash of the two surfaces of one side.
  std::uint64_t hash(JawSide side) const { return at(side).hash; }

  /// Smallest over the sides of (gap at X_CM - gap at rest), mm. Moving the mandible by d changes
  /// it by at most d.
  double slack_mm(const Pose& X_CM);

  /// Distance from condyle to fossa on one side, mm. `start` speeds up the next query nearby.
  double gap_mm(JawSide side, const Pose& X_CM, TrianglePair& start) const;

  /// gap_mm < limit_mm, decided much faster.
  bool nearer_than(double limit_mm, JawSide side, const Pose& X_CM) const;

 private:
  struct Side {
    CollisionMesh condyle, fossa;
    double rest_gap_mm = 0;
    std::uint64_t hash = 0;
    TrianglePair last;  // start of the next query
  };
  const Side& at(JawSide side) const { return sides_[side == JawSide::left ? 0 : 1]; }
  std::vector<Side> sides_;
};

}  // namespace condyle
