#include "render/scene/overlay_passes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "render/mesh/vertex_normals.h"
#include "render/shaders/shaders.h"

namespace condyle {
namespace {

// On a light backdrop: lines of this width get a border, of this fraction of their width.
constexpr float min_bordered_px = 1.5f, border_fraction = 0.35f;

/// Later ones cover earlier ones where solids overlap: teeth in bone, bone in flesh.
int order_of_caps(Role role) {
  if (role == Role::face) return 0;
  if (is_teeth(role)) return 3;
  return collides(role) ? 2 : 1;
}

bool has_stencil() {
  GLint target = 0, kind = GL_NONE;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER,
                                        target == 0 ? GL_STENCIL : GL_STENCIL_ATTACHMENT,
                                        GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &kind);
  return kind != GL_NONE;
}

void blend_over() {
  // Colours are premultiplied when they are blended, like translucent parts.
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

}  // namespace

bool shows_caps(const PictureView& view) {
  // From the kept side the surfaces themselves hide the cut.
  return view.capped && view.clip_plane.dot(view.eye.homogeneous()) < 0 && has_stencil();
}

OverlayPasses::OverlayPasses()
    : cap_("cap", cap_shaders()),
      tint_("tint", tint_shaders()),
      depth_("depth", depth_shaders()),
      line_("line", line_shaders()),
      dot_("dot", marker_shaders()),
      fibres_("fibres", fibre_shaders()) {}

void OverlayPasses::set_lines(const std::string& name, const LineSet& lines) {
  if (lines.empty()) {
    sets_.erase(name);
    return;
  }
  auto& kept = sets_[name];
  kept.set = lines;
  auto colors = lines.colors;
  colors.resize(lines.ends.size() / 2, lines.color);
  kept.lines.send(lines.ends, colors);
  kept.dots.send(lines.dots);
}

void OverlayPasses::set_sheet(const std::string& name, const GlassSheet& sheet) {
  if (sheet.empty()) {
    sheets_.erase(name);
    return;
  }
  auto& kept = sheets_[name];
  if (!kept.mesh || kept.triangles != sheet.triangles) {
    kept.triangles = sheet.triangles;
    kept.mesh.emplace(sheet.positions, sheet.triangles, GpuMesh::Use::overlay);
    // The tint has its own colour, but the driver reads these.
    const std::vector<GpuMesh::Bytes> none(sheet.positions.size());
    kept.mesh->send_colors(none);
    kept.mesh->send_extras(none);
  }
  kept.positions = sheet.positions;
  kept.color = sheet.color;
  kept.opacity = sheet.opacity;
  vertex_normals(sheet.positions, sheet.triangles, normals_);
  kept.mesh->send_shape(sheet.positions, normals_);
}

void OverlayPasses::begin(GlProgram& program, const PictureView& view,
                          const Eigen::Matrix4f& model) {
  program.use();
  view.lights.set_in(program);
  program.set("model", model);
  program.set("view_projection", view.view_projection);
  program.set("eye", view.eye);
  program.set("opacity", 1.f);
  program.set("clip_plane", nothing_clipped);
  program.set("cut_ball", no_ball);
}

template <class Draw>
void OverlayPasses::cap(const DrawItem& item, const Eigen::Matrix4f& model,
                        const Eigen::Vector3f& color, const PictureView& view, const Draw& draw) {
  // Winding number of the solid where the line of sight crosses the plane.
  glClear(GL_STENCIL_BUFFER_BIT);
  glStencilFunc(GL_ALWAYS, 0, 0xff);
  glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
  glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
  glDisable(GL_DEPTH_TEST);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  begin(depth_, view, model);
  depth_.set("clip_plane", view.clip_plane);
  glEnable(GL_CLIP_DISTANCE0);
  draw();
  glDisable(GL_CLIP_DISTANCE0);

  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glStencilFunc(GL_NOTEQUAL, 0, 0xff);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  begin(cap_, view, Eigen::Matrix4f::Identity());
  set_cut(cap_, item, view);
  cap_.set("cut", Eigen::Vector3f(color.array().pow(2.2f)));
  cap_.set("clip_plane", nothing_clipped);  // the cap lies in the plane itself
  if (item.holed) glEnable(GL_CLIP_DISTANCE1);
  glBindVertexArray(quad_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glDisable(GL_CLIP_DISTANCE1);
}

void OverlayPasses::caps(std::span<const DrawItem> items, const PictureView& view,
                         const MouthCavity* mouth, std::span<const SectionSolid> within) {
  std::vector<const DrawItem*> cut;
  for (const auto& item : items)
    if (item.clipped && item.opaque()) cut.push_back(&item);
  if (cut.empty() || !shows_caps(view)) return;
  std::stable_sort(cut.begin(), cut.end(), [](const DrawItem* a, const DrawItem* b) {
    return order_of_caps(a->role()) < order_of_caps(b->role());
  });

  Eigen::AlignedBox3f box;
  for (const auto* item : cut) box.extend(item->box());
  const float half = box.diagonal().norm() + 100;
  const Eigen::Vector3f middle =
      box.center() + view.clip_plane.dot(box.center().homogeneous()) * view.cut_normal;
  const Eigen::Vector3f u = half * view.cut_normal.unitOrthogonal(), v = view.cut_normal.cross(u);
  const std::array<Eigen::Vector3f, 4> corners = {middle - u - v, middle + u - v, middle - u + v,
                                                  middle + u + v};
  glBindVertexArray(quad_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, sizeof corners, corners.data(), GL_STREAM_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);

  glEnable(GL_STENCIL_TEST);
  glDisable(GL_CULL_FACE);
  glStencilMask(0xff);
  glClearStencil(0);
  const bool tongue = std::any_of(items.begin(), items.end(),
                                  [](const DrawItem& item) { return item.role() == Role::tongue; });
  for (const auto* item : cut) {
    const bool hollow = mouth && item->role() == Role::face;
    item->drawable->cover(hollow ? mouth->fan() : std::vector<Eigen::Vector3i>());
    cap(*item, item->model, cut_color_of(item->role()), view, [&] {
      item->drawable->mesh.draw();
      item->drawable->mesh.draw_cover();
      if (hollow) mouth->mesh().draw();
    });
    if (!hollow) continue;
    for (const SectionSolid& solid : within) {
      if (solid.with_tongue && !tongue) continue;  // hidden
      cap(*item, Eigen::Matrix4f::Identity(), solid.color, view, [&] { solid.mesh.draw(); });
    }
  }
  glDepthFunc(GL_LESS);
  glDisable(GL_STENCIL_TEST);
}

namespace {

/// Triangles with edges of similar length on the screen, and how dark their lines are.
struct EdgeClass {
  float opacity;
  std::vector<Eigen::Vector3i> triangles = {};
};

/// Lines of a pixel's width that lie closer than a few pixels would fill the surface: shorter edges
/// are drawn paler, so that together they darken it by less than a half.
std::vector<EdgeClass> edge_classes(const GpuMesh& mesh, const Eigen::Matrix4f& model,
                                    const PictureView& view) {
  constexpr float min_px = 0.7f, factor = 1.4f, opacity_per_px = 0.05f, most = 0.5f;
  std::vector<EdgeClass> classes;
  float opacity = opacity_per_px * min_px;
  for (; opacity < most; opacity *= factor) classes.push_back({opacity});
  classes.push_back({most});
  const Eigen::Matrix4f to_screen = view.view_projection * model;
  const Eigen::Array2f half(0.5f * static_cast<float>(view.width),
                            0.5f * static_cast<float>(view.height));
  std::vector<Eigen::Array2f> places;
  places.reserve(mesh.points().size());
  for (const auto& p : mesh.points()) {
    const Eigen::Vector4f q = to_screen * p.homogeneous();
    places.emplace_back(half * q.head<2>().array() / std::max(q.w(), 1e-3f));
  }
  const auto place = [&](int v) -> const Eigen::Array2f& {
    return places[static_cast<std::size_t>(v)];
  };
  for (const auto& t : mesh.fine().triangles) {
    const Eigen::Array2f u = place(t[1]) - place(t[0]), v = place(t[2]) - place(t[0]);
    // The edge of an equilateral triangle of that area: narrow at an outline, where lines crowd.
    const float edge_px = std::sqrt(2.309f * 0.5f * std::abs(u.x() * v.y() - u.y() * v.x()));
    const float steps = std::log(std::max(edge_px / min_px, 1.f)) / std::log(factor);
    classes[std::min(static_cast<std::size_t>(steps), classes.size() - 1)].triangles.push_back(t);
  }
  return classes;
}

}  // namespace

void OverlayPasses::wireframe(const DrawItem& item, const PictureView& view) {
  begin(tint_, view, item.model);
  begin_cut(tint_, item, view);
  tint_.set("tint", Eigen::Vector3f(0.004f, 0.006f, 0.010f));
  tint_.set("rim", 0.f);
  tint_.set("moved", 0.f);
  if (item.drawable->closed && !item.cut()) {
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
  } else {
    glDisable(GL_CULL_FACE);
  }
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_LEQUAL);
  // Lines are offset to the front by the slope of their triangle, which is unbounded at an outline:
  // they would appear in front of the skin. So they are drawn only where the surface itself is
  // visible.
  const bool marks = has_stencil();
  if (marks) {
    glStencilMask(0xff);
    glClearStencil(0);
    glClear(GL_STENCIL_BUFFER_BIT);
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_ALWAYS, 1, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(0, -4);
    item.mesh().draw();
    glDisable(GL_POLYGON_OFFSET_FILL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glStencilFunc(GL_EQUAL, 1, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  }
  blend_over();
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glEnable(GL_POLYGON_OFFSET_LINE);
  glPolygonOffset(-1, -2);
  for (const auto& [opacity, triangles] : edge_classes(item.mesh(), item.model, view)) {
    tint_.set("opacity", opacity);
    item.mesh().draw(triangles);
  }
  glDisable(GL_POLYGON_OFFSET_LINE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glDisable(GL_STENCIL_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  end_cut();
}

void OverlayPasses::ghost(const DrawItem& item, const Ghost& look, const PictureView& view) {
  // Skin that has not moved would z-fight with its own ghost.
  const float moved = item.role() == Role::face ? 1 : 0;
  glass(item.drawable->rest_mesh(), look.color, static_cast<float>(look.opacity), view, moved);
}

void OverlayPasses::sheets(const PictureView& view) {
  for (const auto& [name, sheet] : sheets_) glass(*sheet.mesh, sheet.color, sheet.opacity, view);
}

void OverlayPasses::glass(const GpuMesh& mesh, const Eigen::Vector3f& color, float opacity,
                          const PictureView& view, float moved) {
  const Eigen::Matrix4f still = Eigen::Matrix4f::Identity();
  glDisable(GL_CULL_FACE);
  begin(depth_, view, still);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  mesh.draw();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  begin(tint_, view, still);
  tint_.set("tint", Eigen::Vector3f(color.array().pow(2.2f)));
  tint_.set("rim", 1.f);
  tint_.set("moved", moved);
  tint_.set("opacity", opacity);
  blend_over();
  glDepthFunc(GL_EQUAL);
  mesh.draw();
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
}

void OverlayPasses::add_bounds(PictureBounds& bounds, const PictureView& view) const {
  for (const auto& [name, kept] : sets_) {
    for (const auto& end : kept.set.ends)
      bounds.add(end, kept.set.width_px * static_cast<float>(view.height) / 1080);
    for (const auto& dot : kept.set.dots) bounds.add(dot, view.radius_px(dot, kept.set.dot_mm));
  }
  for (const auto& [name, sheet] : sheets_)
    for (const auto& place : sheet.positions) bounds.add(place, 0);
  for (const auto& [name, shown] : bodies_)
    for (const auto& place : shown.body.positions) bounds.add(place, 0);
}

void OverlayPasses::lines(const PictureView& view, int width, int height) {
  blend_over();
  glDisable(GL_CULL_FACE);
  glDepthMask(GL_FALSE);
  glEnable(GL_PROGRAM_POINT_SIZE);
  for (auto& [name, kept] : sets_) {
    const LineSet& set = kept.set;
    for (const bool through : {true, false}) {
      const float opacity = set.opacity * (through ? set.through : 1);
      if (!(opacity > 0)) continue;
      (through ? glDisable : glEnable)(GL_DEPTH_TEST);
      if (!kept.lines.empty()) {
        line_.use();
        line_.set("view", view.view);
        line_.set("projection", view.projection);
        line_.set("half_picture", Eigen::Vector2f(0.5f * static_cast<float>(width),
                                                  0.5f * static_cast<float>(height)));
        // A line thinner than a pixel is drawn fainter instead.
        const float line_width = set.width_px * static_cast<float>(height) / 1080;
        const bool bordered = view.light && set.width_px >= min_bordered_px;
        line_.set("half_width", std::max(0.5f, 0.5f * line_width));
        line_.set("border", bordered ? std::max(0.8f, border_fraction * line_width) : 0);
        line_.set("near", 1.f);
        line_.set("nearer", 0.8f / view.away);
        line_.set("opacity", opacity * std::min(1.f, line_width));
        kept.lines.draw();
      }
      if (!kept.dots.empty()) {
        dot_.use();
        dot_.set("view", view.view);
        dot_.set("projection", view.projection);
        dot_.set("radius", set.dot_mm);
        dot_.set("nearer", 1.2f * set.dot_mm);
        dot_.set("pixels_per_unit", view.pixels_per_unit);
        dot_.set("opacity", opacity);
        dot_.set("color", set.color);
        kept.dots.draw();
      }
    }
  }
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_PROGRAM_POINT_SIZE);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

}  // namespace condyle
