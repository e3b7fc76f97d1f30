#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

struct LoopFill {
  std::vector<Eigen::Vector3i> triangles;  // counter-clockwise, indices of points
  int forced = 0;                          // ears that overlap: loops that cross themselves
  int turned = 0;                          // triangles of negative area
};

/// Triangulates the area between closed loops in the plane with the loops' own points and edges
/// only, so that what shares the loops stays joined. Loops that run counter-clockwise are outlines,
/// the others holes. Loops that cross are filled, too, with some triangles turned.
/// Method: holes are joined to their outline by bridges, ears are clipped (Meisters 1975; Eberly
/// 2002), edges are flipped until they are Delaunay (Lawson 1977).
LoopFill fill_loops(std::span<const Eigen::Vector2d> points,
                    const std::vector<std::vector<int>>& loops);

}  // namespace condyle
