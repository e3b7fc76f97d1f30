#pragma once

#include <Eigen/Core>
#include <vector>

#include "render/gl/gpu_mesh.h"
#include "render/mesh/cover_grid.h"

namespace condyle {

/// The viewpoint of a picture or of a shadow map.
struct Viewpoint {
  Eigen::Matrix4f view_projection;  // world to clip space
  Eigen::Vector4f eye;              // position and 1, or direction towards it and 0
  int width, height;                // pixels
};

/// Which sides of triangles are drawn.
enum class Sides { both, front, back };

/// Selects potentially visible triangles of a surface: within the picture, facing the eye, and not
/// occluded. Culling changes no pixel.
class Visibility {
 public:
  /// surface: of the mesh. model: rigid. cover: null or empty covers nothing. Returns triangles of
  /// the surface in their order, valid until the next call.
  const std::vector<Eigen::Vector3i>& choose(const GpuMesh& mesh, const GpuMesh::Surface& surface,
                                             const Eigen::Matrix4f& model, const Viewpoint& from,
                                             Sides sides, const CoverGrid* cover = nullptr);

 private:
  std::vector<Eigen::Vector4f> projected_;  // pixels, depth and 1; 0 in front of the near plane
  std::vector<int> turn_of_;                // the call in which a corner was projected
  int turn_ = 0;
  std::vector<Eigen::Vector3i> chosen_;
};

}  // namespace condyle
