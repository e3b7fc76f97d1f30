#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "engine/collide/solid.h"

namespace condyle {

/// Signed distance to a surface: negative inside closed shells; open shells have no inside and give
/// an unsigned distance. Body coordinates.
class SignedSurface {
 public:
  /// Welded mesh. throws: InputError, see require_sound.
  explicit SignedSurface(const TriMesh& mesh);

  /// mm; exact outside, a lower bound of the depth inside where shells overlap.
  double distance(const Eigen::Vector3d& p) const;

  bool has_inside() const { return solid_.open_shell_count() < solid_.shell_count(); }
  bool has_open_shells() const { return open_ != nullptr; }
  const Box& box() const { return box_; }

 private:
  Solid solid_;
  std::unique_ptr<TriangleTree> open_;  // of the open shells
  Box box_;
};

/// The shells that bound a solid, facing outward, without cavities: see solid_shells.
TriMesh closed_shells(const TriMesh& mesh);

/// Distance of each point to the surface, mm, points given in world coordinates; not searched, and
/// infinite, farther than `reach_mm` from the surface's box.
std::vector<float> distances_to(const SignedSurface& surface, const Pose& X_WS,
                                std::span<const Eigen::Vector3d> points, double reach_mm,
                                int threads);

}  // namespace condyle
