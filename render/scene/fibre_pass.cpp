#include <vector>

#include "render/mesh/vertex_normals.h"
#include "render/scene/overlay_passes.h"

namespace condyle {

void OverlayPasses::set_body(const std::string& name, const FibreBody& body) {
  if (body.empty()) {
    bodies_.erase(name);
    return;
  }
  auto& kept = bodies_[name];
  if (!kept.mesh || kept.body.triangles != body.triangles) {
    kept.mesh.emplace(body.positions, body.triangles, GpuMesh::Use::overlay);
    kept.mesh->send_extras(std::vector<GpuMesh::Bytes>(body.positions.size()));
    kept.body = {};
  }
  if (kept.body.colors != body.colors) {
    std::vector<GpuMesh::Bytes> colors;
    colors.reserve(body.colors.size());
    for (const auto& c : body.colors)
      colors.push_back({to_byte(c.x()), to_byte(c.y()), to_byte(c.z()), 255});
    kept.mesh->send_colors(colors);
  }
  if (kept.body.fibres != body.fibres) kept.mesh->send_values(body.fibres);
  kept.body = body;
  vertex_normals(body.positions, body.triangles, normals_);
  kept.mesh->send_shape(body.positions, normals_);
}

void OverlayPasses::bodies(const PictureView& view, bool clipped) {
  if (bodies_.empty()) return;
  constexpr float behind_skin = 0.45f;  // opacity
  // In front of everything without losing their own order: nearly the whole range is the others'.
  constexpr double front_range = 0.02;
  if (view.opaque_face) glDepthRange(0, front_range);
  const Eigen::Vector4f plane = clipped ? view.clip_plane : nothing_clipped;
  const auto place = [&](GlProgram& program) {
    begin(program, view, Eigen::Matrix4f::Identity());
    program.set("clip_plane", plane);
  };
  glDisable(GL_CULL_FACE);
  if (clipped) glEnable(GL_CLIP_DISTANCE0);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const float all = view.opaque_face ? behind_skin : 1;
  // Opaque ones first, each translucent one by its nearest layer.
  for (const bool opaque : {true, false})
    for (const auto& [name, shown] : bodies_) {
      const float opacity = all * shown.body.opacity;
      if ((opacity >= 1) != opaque) continue;
      if (!opaque) {
        place(depth_);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        shown.mesh->draw();
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDepthFunc(GL_EQUAL);
        glEnable(GL_BLEND);
      }
      place(fibres_);
      fibres_.set("together", 1.f);
      fibres_.set("opacity", opacity);
      fibres_.set("cut_normal", view.cut_normal);
      shown.mesh->draw();
      glDisable(GL_BLEND);
      glDepthFunc(GL_LESS);
    }
  glDisable(GL_CLIP_DISTANCE0);
  glDepthRange(0, 1);
}

}  // namespace condyle
