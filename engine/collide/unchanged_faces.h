#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/collide/field_face.h"
#include "engine/collide/shells.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {

/// The faces of a piece that a cut left as they were, and those of the uncut mesh that the piece
/// does not have.
class UnchangedFaces {
 public:
  /// `faces`: of the piece's shells. `reach_mm`: the largest distance from the piece, mm, at which
  /// missing faces are looked for.
  UnchangedFaces(std::span<const Shell> piece, std::span<const FieldFace> faces,
                 std::span<const Shell> uncut, double reach_mm);

  bool contains(int face) const { return unchanged_[static_cast<std::size_t>(face)]; }

  /// Whether all faces that the piece lacks are farther than `reach` (mm) from p. Together with the
  /// distance of p from the piece it may be at most reach_mm.
  bool are_missing_beyond(const Eigen::Vector3d& p, double reach) const {
    return !missing_ || missing_->nearest(p, reach).triangle < 0;
  }

 private:
  std::vector<bool> unchanged_;  // of the piece's faces
  std::optional<TriangleTree> missing_;
};

}  // namespace condyle
