#include "render/occlusion_culling.h"

#include "render/shaders.h"

namespace condyle {

OcclusionCulling::OcclusionCulling()
    : program_("depth", depth_shaders().vertex, depth_shaders().fragment) {
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
  // Counter-clockwise from outside: only the near sides are asked about.
  const GLubyte indices[] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                             2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, sizeof corners, corners, GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof indices, indices, GL_STATIC_DRAW);
  glBindVertexArray(0);
}

OcclusionCulling::~OcclusionCulling() {
  glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

void OcclusionCulling::start() { used_ = 0; }

int OcclusionCulling::ask(const GpuMesh& mesh, const Eigen::Matrix4f& model_view_projection) {
  const int answers = used_;
  used_ += static_cast<int>(mesh.pieces().size());
  while (static_cast<int>(queries_.size()) < used_) {
    queries_.push_back(0);
    glGenQueries(1, &queries_.back());
  }
  program_.use();
  program_.set("clip_plane", Eigen::Vector4f(0, 0, 0, 1));  // nothing is cut
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_CLIP_DISTANCE1);
  program_.set("view_projection", model_view_projection);
  glBindVertexArray(array_);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glDepthMask(GL_FALSE);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  int query = answers;
  for (const auto& piece : mesh.pieces()) {
    constexpr float air_mm = 0.5f;
    Eigen::Matrix4f box = Eigen::Matrix4f::Identity();
    box.diagonal().head<3>() = piece.box.sizes().array() + 2 * air_mm;
    box.topRightCorner<3, 1>() = piece.box.min().array() - air_mm;
    program_.set("model", box);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, queries_[static_cast<std::size_t>(query++)]);
    glDrawElements(GL_TRIANGLES, 36, GL_UNSIGNED_BYTE, nullptr);
    glEndQuery(GL_ANY_SAMPLES_PASSED);
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  return answers;
}

void OcclusionCulling::draw(const GpuMesh& mesh, int answers) const {
  for (const auto& piece : mesh.pieces()) {
    glBeginConditionalRender(queries_[static_cast<std::size_t>(answers++)], GL_QUERY_WAIT);
    mesh.draw(piece);
    glEndConditionalRender();
  }
}

}  // namespace condyle
