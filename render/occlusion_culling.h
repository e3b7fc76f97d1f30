#pragma once

#include <Eigen/Core>
#include <vector>

#include "render/gpu_mesh.h"

namespace condyle {

/// Leaves out pieces of surfaces that lie wholly behind what is drawn already: asks the card
/// whether any point of a piece's box would be seen, then draws on that condition. Never drops what
/// is seen.
class OcclusionCulling {
 public:
  OcclusionCulling();
  ~OcclusionCulling();
  OcclusionCulling(const OcclusionCulling&) = delete;
  OcclusionCulling& operator=(const OcclusionCulling&) = delete;

  /// Forgets the questions of the last picture.
  void start();
  /// Asks about all pieces of a mesh; returns where their answers begin. Colours and depths are not
  /// touched. `model_view_projection` maps the mesh to clip space.
  int ask(const GpuMesh& mesh, const Eigen::Matrix4f& model_view_projection);
  /// Draws what may be seen of the mesh, with the program in use.
  void draw(const GpuMesh& mesh, int answers) const;

 private:
  GlProgram program_;
  GlVertexArray array_;
  GlBuffer corners_, indices_;
  std::vector<GLuint> queries_;
  int used_ = 0;
};

}  // namespace condyle
