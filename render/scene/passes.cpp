#include "render/scene/passes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/math/smooth_step.h"
#include "render/face/lashes.h"
#include "render/shaders/skin_detail.h"
#include "render/shaders/skin_table.h"

namespace condyle {
namespace {

constexpr int shadow_side = 1024;
constexpr int colour_count = 1024;  // of the lookup table of a colour map
constexpr float marker_radius_mm = 1.2f;
constexpr float mouth_depth_mm = 24;  // over which the light inside the mouth falls to 1/e

constexpr std::size_t max_map_lines = 4;
constexpr std::array<const char*, max_map_lines> map_line_names = {"map_lines[0]", "map_lines[1]",
                                                                   "map_lines[2]", "map_lines[3]"};

void cull_by_closure(const DrawItem& item) {
  if (item.drawable->closed && !item.cut()) {
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
  } else {
    glDisable(GL_CULL_FACE);
  }
}

/// The sides that remain after culling by closure.
Sides sides_of(const DrawItem& item) {
  return item.drawable->closed && !item.cut() ? Sides::front : Sides::both;
}

const GpuMesh::Surface& surface_of(const DrawItem& item, const PictureView& view) {
  return item.surface(view.coarse);
}

Viewpoint eye_of(const PictureView& view) {
  return {view.view_projection, view.eye.homogeneous(), view.width, view.height};
}

/// While it exists, triangles are drawn slightly farther away. Used for the inner side of the skin:
/// slivers that a movement turns over lie on their neighbours.
struct BehindSlivers {
  BehindSlivers() {
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1, 2);
  }
  ~BehindSlivers() { glDisable(GL_POLYGON_OFFSET_FILL); }
  BehindSlivers(const BehindSlivers&) = delete;
  BehindSlivers& operator=(const BehindSlivers&) = delete;
};

/// Whether the surface buffer can store a part in pictures of this size.
bool can_store(const DrawItem& item, const PictureView& view) {
  return SurfaceBuffer::fits(view.width, view.height) && !item.cut() && !item.drawable->mapped;
}

}  // namespace

void set_cut(GlProgram& program, const DrawItem& item, const PictureView& view) {
  // Not only by the clip switches: Mesa's rasteriser clips by inaccurate distances.
  program.set("clip_plane", item.clipped ? view.clip_plane : nothing_clipped);
  program.set("cut_ball", item.holed ? view.cut_ball : no_ball);
  const Eigen::Vector3f color = cut_color_of(item.role()).array().pow(2.2f);
  program.set("cut", Eigen::Vector3f(color));
  program.set("cut_normal", view.cut_normal);
}

void begin_cut(GlProgram& program, const DrawItem& item, const PictureView& view) {
  set_cut(program, item, view);
  (item.clipped ? glEnable : glDisable)(GL_CLIP_DISTANCE0);
  (item.holed ? glEnable : glDisable)(GL_CLIP_DISTANCE1);
}

void end_cut() {
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_CLIP_DISTANCE1);
}

void PictureView::set_rays_in(GlProgram& program) const {
  // For pixel x, y: the point at unit distance from the eye is ray + x * ray_right + y * ray_up.
  const Eigen::Matrix3f to_world = view.topLeftCorner<3, 3>().transpose();
  const float right = 2 / (static_cast<float>(width) * projection(0, 0)),
              up = 2 / (static_cast<float>(height) * projection(1, 1));
  program.set("ray", Eigen::Vector3f(to_world * Eigen::Vector3f(-1 / projection(0, 0),
                                                                -1 / projection(1, 1), -1)));
  program.set("ray_right", Eigen::Vector3f(right * to_world.col(0)));
  program.set("ray_up", Eigen::Vector3f(up * to_world.col(1)));
}

Eigen::AlignedBox3f DrawItem::box() const {
  Eigen::AlignedBox3f moved;
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = static_cast<Eigen::AlignedBox3f::CornerType>(corner);
    moved.extend((model * drawable->box.corner(at).homogeneous()).head<3>());
  }
  return moved;
}

Passes::Passes()
    : surfaces_("surface", surface_shaders),
      skins_("skin", skin_shaders),
      interiors_("interior", interior_shaders),
      kept_("surface", keep_shaders),
      depth_("depth", depth_shaders()),
      marker_("marker", marker_shaders()),
      carry_("carry", carry_shaders()),
      place_("place", place_shaders()),
      blend_("blend", blend_shaders()),
      edges_("edges", edge_shaders()),
      inner_("inner", inner_shaders()),
      shadow_map_(shadow_side),
      software_(draws_in_software()) {
  const auto table = make_skin_table();
  glBindTexture(GL_TEXTURE_2D, skin_table_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, SkinTable::width, SkinTable::height, 0, GL_RGB,
               GL_UNSIGNED_BYTE, table.rgb.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);

  constexpr int side = SkinDetail::side;
  glBindTexture(GL_TEXTURE_3D, skin_detail_);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, side, side, side, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               skin_detail().rgba.data());
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glGenerateMipmap(GL_TEXTURE_3D);
}

void Passes::set_colour_map(const ColourMap& map) {
  colour_map_ = map;
  std::vector<std::uint8_t> table;
  for (int i = 0; i < colour_count; ++i) {
    // The last entry is still within the range.
    const float s = (static_cast<float>(i) + 0.5f) / colour_count;
    const Eigen::Vector3f color = color_of(map, map.low() + s * (map.high() - map.low()));
    for (int k = 0; k < 3; ++k)
      table.push_back(static_cast<std::uint8_t>(std::lround(255 * color[k])));
  }
  glBindTexture(GL_TEXTURE_2D, colour_table_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, colour_count, 1, 0, GL_RGB, GL_UNSIGNED_BYTE,
               table.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
}

void Passes::shadow_map(std::span<const DrawItem> items, const PictureView& view) {
  Eigen::Matrix4f to_clip = Eigen::Matrix4f::Identity();
  to_clip.diagonal().head<3>().setConstant(2);
  to_clip.topRightCorner<3, 1>().setConstant(-1);
  const Viewpoint light = {to_clip * view.shadow,
                           (Eigen::Vector4f() << view.lights.key_direction, 0).finished(),
                           shadow_side, shadow_side};
  constexpr float slope = 2, units = 4;
  shadow_map_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(slope, units);
  depth_.use();
  depth_.set("view_projection", light.view_projection);
  // Translucent parts transmit light; parts enclosed by an opaque face cast no shadow beyond that
  // of the face.
  Eigen::AlignedBox3f enclosed;
  for (const auto& item : items)
    if (item.opaque() && !item.cut() && item.role() == Role::face) enclosed.extend(item.box());
  for (const auto& item : items) {
    if (!item.opaque()) continue;
    const bool shows = item.role() == Role::face || is_teeth(item.role());
    if (!shows && !enclosed.isEmpty() && enclosed.contains(item.box())) continue;
    cull_by_closure(item);
    begin_cut(depth_, item, view);
    depth_.set("model", item.model);
    const auto& mesh = item.drawable->mesh;
    mesh.draw(visibility_.choose(mesh, mesh.coarse(), item.model, light, sides_of(item)));
    end_cut();
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  glFlush();  // without a GPU it is drawn in parallel with the following
}

void Passes::background(const PictureView& view) {
  if (view.backdrop && !has_backdrop_) background_.draw(view.width, view.height, *view.backdrop);
}

GlProgram& Passes::Programs::of(const Shading& shading) {
  const auto found = built_.find(shading);
  if (found != built_.end()) return found->second;
  return built_.try_emplace(shading, what_, source_(shading)).first->second;
}

void Passes::place(GlProgram& program, const DrawItem& item, const PictureView& view) {
  program.set("model", item.model);
  program.set("view_projection", view.view_projection);
  program.set("eye", view.eye);
  // The shading of the face's folds follows their opening.
  program.set("together", item.role() == Role::eyes   ? view.skin_opacity
                          : item.role() == Role::face ? 1.f
                                                      : view.at_rest);
  const bool in_mouth = view.dark_mouth && item.role() != Role::eyes && !is_piece(item.role());
  program.set("cavity", Eigen::Vector2f(view.lips_y, in_mouth ? 1 / mouth_depth_mm : 0.f));
  program.set("window_ball", view.window_ball);
  // Thinner lashes would be drawn as dots. Where they are seen through, another program draws their
  // depths.
  const auto& skin = item.drawable->behind_lashes;
  const bool grow = skin && item.opaque();
  program.set("lashes", grow ? Eigen::Vector2f(thickest_lash_mm, lash_pixels / view.pixels_per_unit)
                             : Eigen::Vector2f::Zero());
  if (grow) program.set("behind_lashes", *skin);
  begin_cut(program, item, view);
}

GlProgram& Passes::begin(Programs& programs, const DrawItem& item, const PictureView& view,
                         bool deferred) {
  const auto& material = item.drawable->material;
  const auto role = item.role();
  const bool mapped = item.drawable->mapped;
  if (mapped) {
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_2D, colour_table_);
  }
  const bool papillae = item.drawable->papillae;
  if (role == Role::face || papillae) {
    glActiveTexture(GL_TEXTURE3);
    glBindTexture(GL_TEXTURE_3D, skin_detail_);
  }
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, skin_table_);
  shadow_map_.bind_depths(4);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, shadow_map_.texture());
  // On skin like glass pores and shadows are hardly visible, and both take long to draw; they come
  // gradually.
  constexpr double glass_opacity = 0.5, full_relief_opacity = 0.75;
  const bool glass = role == Role::face && item.opacity < glass_opacity;
  const auto& neck_cut = item.drawable->neck_cut;
  const bool vanishing = neck_cut && !mapped && !item.clipped && view.backdrop;
  GlProgram& program =
      programs.of({.shadowed = view.shadows && !glass,
                   .mapped = mapped,
                   .coated = material.coat > 0,
                   .cuttable = item.cut(),
                   .seen_through = !item.opaque(),
                   .skin = role == Role::face,
                   .smooth_skin = (role == Role::face || papillae) && (view.coarse || glass),
                   .papillae = papillae,
                   .vanishing = vanishing,
                   .deferred = deferred});
  program.use();
  view.lights.set_in(program);
  program.set("shadow_matrix", view.shadow);
  program.set("shadow_map", 0);
  program.set("skin_table", 1);
  program.set("skin_detail", 3);
  program.set("pixel_size", 1 / view.pixels_per_unit);
  program.set("shadow_depth", 4);
  program.set("shadow_scale", Eigen::Vector3f(view.shadow.topLeftCorner<3, 3>().rowwise().norm()));
  program.set("two_sided", item.drawable->closed || role == Role::face ? 0.f : 1.f);
  program.set("opacity", static_cast<float>(item.opacity));
  program.set("relief", static_cast<float>(smooth_step((item.opacity - glass_opacity) /
                                                       (full_relief_opacity - glass_opacity))));
  program.set("roughness", material.roughness);
  program.set("reflectance", material.reflectance);
  program.set("wrap", material.wrap);
  program.set("scatter", material.scatter);
  program.set("coat", material.coat);
  const Eigen::AlignedBox3f& lips = item.drawable->lips;
  constexpr float nowhere_mm = 1e-3f;
  program.set("mouth_middle", lips.isEmpty() ? Eigen::Vector3f::Zero().eval() : lips.center());
  program.set("mouth_half", lips.isEmpty() ? Eigen::Vector3f::Constant(nowhere_mm).eval()
                                           : (0.5f * lips.sizes()).eval());
  program.set("skin_light", item.drawable->skin_light);
  program.set("open_mouth", view.sectioned ? 1.f : 1 - view.at_rest);
  if (vanishing) {
    constexpr float gone_mm = 12, over_mm = 38;  // above the cut
    constexpr float neck_half_mm = 55;
    program.set("neck_end", Eigen::Vector2f(*neck_cut + gone_mm, 1 / over_mm));
    program.set("neck_sides", Eigen::Vector2f(lips.center().x(), neck_half_mm));
    Background::set_in(program, view.width, view.height, *view.backdrop);
  }
  program.set("mapped_up_to", view.mapped_up_to);
  program.set("colour_table", 2);
  if (mapped) {
    program.set("map_range", Eigen::Vector2f(colour_map_.low(), colour_map_.high()));
    program.set("map_beyond", colour_map_.beyond);
    for (std::size_t i = 0; i < max_map_lines; ++i)
      program.set(map_line_names[i],
                  i < colour_map_.lines.size() ? colour_map_.lines[i] : colour_map_.low() - 100);
  }
  place(program, item, view);
  return program;
}

const std::vector<Eigen::Vector3i>& Passes::seen_of(const DrawItem& item, const PictureView& view) {
  const auto& mesh = item.mesh();
  const auto& surface = surface_of(item, view);
  if (item.role() != Role::face) {
    cull_by_closure(item);
    return visibility_.choose(mesh, surface, item.model, eye_of(view), sides_of(item), &cover_);
  }
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  return visibility_.choose(mesh, surface, item.model, eye_of(view), Sides::front);
}

void Passes::shade(const DrawItem& item, const PictureView& view) {
  const bool skin = item.role() == Role::face && !item.drawable->mapped;
  begin(skin ? skins_ : surfaces_, item, view, false);
  item.mesh().draw(seen_of(item, view));
  end_cut();
  if (item.role() == Role::face) shade_interior(item, view);
}

void Passes::shade_interior(const DrawItem& item, const PictureView& view) {
  glFlush();  // as after the shadow map
  if (item.drawable->closed && !item.cut()) return;
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  begin(interiors_, item, view, false).set("capped", view.capped && item.opaque() ? 1.f : 0.f);
  const BehindSlivers behind;
  item.mesh().draw(visibility_.choose(item.mesh(), surface_of(item, view), item.model, eye_of(view),
                                      Sides::back, &cover_));
  end_cut();
}

void Passes::cover_by(std::span<const DrawItem> faces, const PictureView& view) {
  cover_.start(view.width, view.height, view.view_projection);
  for (const auto& item : faces) {
    if (!view.may_cull || item.cut()) continue;
    const auto& mesh = item.drawable->mesh;
    const auto& surface = surface_of(item, view);
    const bool coarse = &surface == &mesh.coarse();
    cover_.add(mesh.points(), surface.corners, surface.triangles,
               coarse ? *item.drawable->coarse_edges : *item.drawable->edges, item.model);
  }
  cover_.finish();
}

void Passes::opaque(std::span<const DrawItem> items, const PictureView& view) {
  std::vector<DrawItem> covering;
  for (const auto& item : items)
    if (item.role() == Role::face && item.opaque()) covering.push_back(item);
  cover_by(covering, view);
  // The face hides most of the rest: drawn first, it avoids shading hidden surfaces.
  std::vector<DrawItem> whole, others;
  for (const bool face : {true, false})
    for (const auto& item : items) {
      if (!item.opaque() || (item.role() == Role::face) != face) continue;
      const bool kept = can_store(item, view) && std::ssize(whole) < SurfaceBuffer::max_surfaces;
      (kept ? whole : others).push_back(item);
    }
  has_backdrop_ = false;
  if (whole.empty() || !view.one_sample) {
    glClearColor(0, 0, 0, 0);
    glClearStencil(0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  }
  if (!whole.empty()) deferred(whole, view);
  for (const auto& item : whole)
    if (item.role() == Role::face) shade_interior(item, view);
  for (const auto& item : others) shade(item, view);
}

void Passes::depth_only(const DrawItem& item, const PictureView& view, Sides sides) {
  if (item.role() == Role::face && sides == Sides::both) {  // its inner side has another depth
    depth_only(item, view, Sides::front);
    depth_only(item, view, Sides::back);
    return;
  }
  if (sides == Sides::both) {
    glDisable(GL_CULL_FACE);
  } else {
    glEnable(GL_CULL_FACE);
    glCullFace(sides == Sides::back ? GL_FRONT : GL_BACK);
  }
  depth_.use();
  depth_.set("view_projection", view.view_projection);
  begin_cut(depth_, item, view);
  depth_.set("model", item.model);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  std::optional<BehindSlivers> behind;
  if (sides == Sides::back) behind.emplace();
  item.mesh().draw(visibility_.choose(item.mesh(), surface_of(item, view), item.model, eye_of(view),
                                      sides, &cover_));
  end_cut();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void Passes::translucent(std::span<const DrawItem> items, const PictureView& view) {
  std::vector<DrawItem> order;
  for (const auto& item : items)
    if (!item.opaque()) order.push_back(item);
  const auto away = [&](const DrawItem& item) { return (item.box().center() - view.eye).norm(); };
  std::stable_sort(order.begin(), order.end(), [&](const DrawItem& a, const DrawItem& b) {
    const bool face_a = a.role() == Role::face, face_b = b.role() == Role::face;
    return face_a != face_b ? face_b : away(a) > away(b);
  });
  // Colours are premultiplied when they are blended, so that an empty background stays exact.
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const auto front_layer = [&](const DrawItem& item, Sides sides, const auto& shaded) {
    depth_only(item, view, sides);
    glDepthFunc(GL_EQUAL);
    glEnable(GL_BLEND);
    shaded();
    glDisable(GL_BLEND);
    glDepthFunc(GL_LESS);
  };
  for (const auto& item : order) {
    const bool face = item.role() == Role::face;
    if (face) cover_by({&item, 1}, view);  // drawn last; it hides most of its inner side
    if (!view.one_sample || !can_store(item, view)) {
      front_layer(item, sides_of(item), [&] { shade(item, view); });
      continue;
    }
    deferred_front(item, view);
    if (face && !item.drawable->closed)
      front_layer(item, Sides::back, [&] { shade_interior(item, view); });
  }
}

void Passes::add_contacts(std::span<const Eigen::Vector3f> points, PictureBounds& bounds,
                          const PictureView& view) {
  for (const auto& point : points) bounds.add(point, view.radius_px(point, marker_radius_mm));
}

void Passes::contacts(const GpuPoints& points, const PictureView& view, bool through) {
  if (points.empty()) return;
  marker_.use();
  marker_.set("view", view.view);
  marker_.set("projection", view.projection);
  marker_.set("radius", marker_radius_mm);
  marker_.set("nearer", 1.2f * marker_radius_mm);
  marker_.set("pixels_per_unit", view.pixels_per_unit);
  marker_.set("color", Eigen::Vector3f(0.835f, 0.369f, 0.f));  // Okabe-Ito vermilion
  glEnable(GL_PROGRAM_POINT_SIZE);
  if (through) {
    // Contacts lie between surfaces.
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    marker_.set("opacity", 0.4f);
    points.draw();
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
  }
  marker_.set("opacity", 1.f);
  points.draw();
  glDisable(GL_PROGRAM_POINT_SIZE);
}

}  // namespace condyle
