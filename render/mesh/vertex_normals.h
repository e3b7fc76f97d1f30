#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// Unit normals of a triangle surface; (0,0,1) where a vertex has no triangle. Weighted so that
/// they are exact on a sphere and a few large triangles do not dominate many small ones. Writes
/// into `normals`, whose memory is reused from frame to frame. source: Max, Weights for computing
/// vertex normals from facet normals, 1999
void vertex_normals(std::span<const Eigen::Vector3f> vertices,
                    std::span<const Eigen::Vector3i> triangles,
                    std::vector<Eigen::Vector3f>& normals);

/// Curvature at each vertex, 1/mm, unsigned: rotation of the normal over the edge length, averaged
/// over the edges and then smoothed twice along them.
std::vector<float> vertex_curvature(std::span<const Eigen::Vector3f> vertices,
                                    std::span<const Eigen::Vector3i> triangles,
                                    std::span<const Eigen::Vector3f> normals);

/// Whether every edge has as many triangles in one direction as in the other: such a surface has no
/// border and never shows its back.
bool is_closed_surface(std::span<const Eigen::Vector3i> triangles);

}  // namespace condyle
