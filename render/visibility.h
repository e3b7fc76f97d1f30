#pragma once

#include <Eigen/Core>
#include <vector>

#include "render/cover_grid.h"
#include "render/gpu_mesh.h"

namespace condyle {

/// From where a picture, or a shadow map, is looked at.
struct Viewpoint {
  Eigen::Matrix4f view_projection;  // world to clip space
  Eigen::Vector4f eye;              // place and 1, or direction toward it and 0
  int width, height;                // pixels
};

/// Which sides of triangles are drawn.
enum class Sides { both, front, back };

/// Chooses what may be seen of a surface: what is in the picture, turns the right way, and does not
/// lie behind what covers. What it leaves out changes no pixel.
class Visibility {
 public:
  /// surface: of the mesh. model: rigid. cover: null or empty covers nothing.
  /// gives: triangles of the surface in their order, valid until the next call.
  const std::vector<Eigen::Vector3i>& choose(const GpuMesh& mesh, const GpuMesh::Surface& surface,
                                             const Eigen::Matrix4f& model, const Viewpoint& from,
                                             Sides sides, const CoverGrid* cover = nullptr);

 private:
  std::vector<Eigen::Vector4f> projected_;  // pixels, depth and 1; 0 before the near plane
  std::vector<int> turn_of_;                // in which call a corner was projected
  int turn_ = 0;
  std::vector<Eigen::Vector3i> chosen_;
};

}  // namespace condyle
