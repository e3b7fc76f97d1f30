#include "render/scene_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "render/drawable.h"
#include "render/framebuffer.h"
#include "render/lights.h"
#include "render/shaders.h"
#include "render/skin_table.h"
#include "render/vertex_normals.h"

namespace condyle {
namespace {

constexpr int shadow_side = 1024;
constexpr double nearly_opaque = 0.999, nearly_hidden = 0.004;
constexpr float marker_radius_mm = 0.9f;

struct Programs {
  GlProgram surface, skin, interior, depth, background, marker;

  static GlProgram build(const char* what, const ShaderSource& source) {
    return {what, source.vertex, source.fragment};
  }
  Programs()
      : surface(build("surface", surface_shaders())),
        skin(build("skin", skin_shaders())),
        interior(build("interior", interior_shaders())),
        depth(build("depth", depth_shaders())),
        background(build("background", background_shaders())),
        marker(build("marker", marker_shaders())) {}
};

/// A drawable as one picture wants it.
struct Item {
  Drawable* drawable;
  double opacity;
  Eigen::Matrix4f model;
  bool is_face() const { return drawable->part->role == Role::face; }
};

void cull(const Drawable& drawable) {
  if (drawable.closed) {
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
  } else {
    glDisable(GL_CULL_FACE);
  }
}

}  // namespace

struct SceneRenderer::State {
  Programs programs;
  std::vector<Drawable> drawables;
  Eigen::AlignedBox3d box;
  GlVertexArray no_attributes;
  GlTexture skin_table;
  DepthMap shadow_map{shadow_side};
  GpuPoints contacts;
  // Of the last frame:
  Pose X_CM;
  bool face_moved = false;
  std::vector<Eigen::Vector3f> normals;  // kept for its memory
  // Kept from picture to picture of one size:
  std::optional<Framebuffer> sampled, resolved;
  int samples_asked = 0;

  explicit State(std::span<const Part> parts) : drawables(make_drawables(parts)) {
    for (const auto& part : parts)
      for (const auto& v : part.mesh.vertices) box.extend(v);
    const auto table = make_skin_table();
    glBindTexture(GL_TEXTURE_2D, skin_table);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, SkinTable::width, SkinTable::height, 0, GL_RGB,
                 GL_UNSIGNED_BYTE, table.rgb.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  }

  Eigen::Vector3f centre() const {
    return box.isEmpty() ? Eigen::Vector3f::Zero() : Eigen::Vector3f(box.center().cast<float>());
  }
  /// Of a sphere about the scene that an open mouth does not leave.
  float radius_mm() const {
    return box.isEmpty() ? 1.f : static_cast<float>(0.5 * box.diagonal().norm() + 45);
  }

  void send_face(Drawable& drawable, std::span<const Eigen::Vector3f> positions) {
    vertex_normals(positions, drawable.part->mesh.triangles, normals);
    drawable.mesh.send_shape(positions, normals);
  }
  std::vector<Item> items(const PictureSettings& settings);
  void draw_shadow_map(const std::vector<Item>& items, const Eigen::Matrix4f& matrix);
  void begin(GlProgram& program, const Item& item, const struct View& view);
  void draw_item(const Item& item, const struct View& view);
  void draw_depth(const Item& item, const struct View& view);
  void draw_contacts(const struct View& view, bool through);
};

/// What all draws of one picture share.
struct View {
  Eigen::Matrix4f view, projection, view_projection, shadow;
  Eigen::Vector3f eye;
  Lights lights;
  bool shadows;
  bool face_closed_off;  // an opaque face keeps the sky out of the mouth
  double skin_opacity;
  float at_rest;  // 1 at rest, 0 when the jaw is away
  float lip_y;    // front of the teeth
  int height;
  double field_of_view_deg;
};

std::vector<Item> SceneRenderer::State::items(const PictureSettings& settings) {
  Eigen::Matrix4f jaw = Eigen::Matrix4f::Identity();
  jaw.topLeftCorner<3, 3>() = X_CM.R.toRotationMatrix().cast<float>();
  jaw.topRightCorner<3, 1>() = X_CM.t.cast<float>();
  std::vector<Item> found;
  for (auto& drawable : drawables) {
    const auto& part = *drawable.part;
    double opacity = 1;
    if (const auto own = settings.part_opacity.find(part.name); own != settings.part_opacity.end())
      opacity = own->second;
    if (part.role == Role::face) opacity *= settings.skin_opacity;
    if (opacity < nearly_hidden || part.mesh.empty()) continue;
    found.push_back({&drawable, opacity > nearly_opaque ? 1.0 : opacity,
                     body_of(part.role) == Body::mandible ? jaw : Eigen::Matrix4f::Identity()});
  }
  return found;
}

void SceneRenderer::State::draw_shadow_map(const std::vector<Item>& all,
                                           const Eigen::Matrix4f& matrix) {
  Eigen::Matrix4f to_clip = Eigen::Matrix4f::Identity();
  to_clip.diagonal().head<3>().setConstant(2);
  to_clip.topRightCorner<3, 1>().setConstant(-1);
  shadow_map.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(2, 4);
  programs.depth.use();
  programs.depth.set("view_projection", Eigen::Matrix4f(to_clip * matrix));
  for (const auto& item : all) {
    if (item.opacity < 1) continue;  // what is seen through lets the light through
    cull(*item.drawable);
    programs.depth.set("model", item.model);
    item.drawable->mesh.draw();
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void SceneRenderer::State::begin(GlProgram& program, const Item& item, const View& view) {
  const auto role = item.drawable->part->role;
  const auto& material = item.drawable->material;
  program.use();
  view.lights.set_in(program);
  program.set("model", item.model);
  program.set("view_projection", view.view_projection);
  program.set("shadow_matrix", view.shadow);
  program.set("eye", view.eye);
  program.set("shadow_map", 0);
  program.set("skin_table", 1);
  program.set("shadows", view.shadows ? 1.f : 0.f);
  program.set("shadow_texel", 1.f / shadow_side);
  program.set("opacity", static_cast<float>(item.opacity));
  program.set("roughness", material.roughness);
  program.set("reflectance", material.reflectance);
  program.set("wrap", material.wrap);
  program.set("scatter", material.scatter);
  program.set("coat", material.coat);
  program.set("together",
              role == Role::eyes ? static_cast<float>(view.skin_opacity) : view.at_rest);
  const bool in_mouth = view.face_closed_off && role != Role::face && role != Role::eyes;
  program.set("cavity", Eigen::Vector2f(view.lip_y, in_mouth ? 1 / 26.f : 0.f));
}

void SceneRenderer::State::draw_item(const Item& item, const View& view) {
  const auto& drawable = *item.drawable;
  if (!item.is_face()) {
    cull(drawable);
    begin(programs.surface, item, view);
    drawable.mesh.draw();
    return;
  }
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  begin(programs.skin, item, view);
  drawable.mesh.draw();
  if (drawable.closed) return;
  glCullFace(GL_FRONT);
  begin(programs.interior, item, view);
  drawable.mesh.draw();
}

void SceneRenderer::State::draw_depth(const Item& item, const View& view) {
  cull(*item.drawable);
  programs.depth.use();
  programs.depth.set("view_projection", view.view_projection);
  programs.depth.set("model", item.model);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  item.drawable->mesh.draw();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void SceneRenderer::State::draw_contacts(const View& view, bool through) {
  if (contacts.empty()) return;
  auto& program = programs.marker;
  program.use();
  program.set("view", view.view);
  program.set("projection", view.projection);
  program.set("radius", marker_radius_mm);
  program.set("nearer", 1.2f * marker_radius_mm);
  program.set("pixels_per_unit",
              static_cast<float>(view.height / 2 /
                                 std::tan(view.field_of_view_deg * std::numbers::pi / 360)));
  glEnable(GL_PROGRAM_POINT_SIZE);
  if (through) {
    // Contacts lie between surfaces: seen faintly through whatever is in front.
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    program.set("opacity", 0.4f);
    contacts.draw();
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
  }
  program.set("opacity", 1.f);
  contacts.draw();
  glDisable(GL_PROGRAM_POINT_SIZE);
}

SceneRenderer::SceneRenderer(std::span<const Part> parts)
    : state_(std::make_unique<State>(parts)) {}

SceneRenderer::~SceneRenderer() = default;

std::pair<Eigen::Vector3d, Eigen::Vector3d> SceneRenderer::bounds() const {
  if (state_->box.isEmpty()) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  return {state_->box.min(), state_->box.max()};
}

void SceneRenderer::update(const FrameState& frame) {
  auto& s = *state_;
  s.X_CM = frame.X_CM;
  for (auto& drawable : s.drawables) {
    if (drawable.part->role != Role::face) continue;
    const auto& rest = drawable.part->mesh.vertices;
    if (frame.face.size() == rest.size()) {
      s.send_face(drawable, frame.face);
    } else if (s.face_moved) {
      std::vector<Eigen::Vector3f> positions;
      for (const auto& v : rest) positions.push_back(v.cast<float>());
      s.send_face(drawable, positions);
    }
    s.face_moved = frame.face.size() == rest.size();
    break;
  }
  std::vector<Eigen::Vector3f> points;
  for (const auto& pair : frame.contacts.pairs)
    for (const auto& contact : pair.contacts) points.push_back(contact.point.cast<float>());
  s.contacts.send(points);
}

void SceneRenderer::draw(const Camera& camera, const PictureSettings& settings) {
  auto& s = *state_;
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);

  auto items = s.items(settings);
  const bool opaque_face = std::any_of(items.begin(), items.end(), [](const Item& item) {
    return item.is_face() && item.opacity >= 1;
  });
  View view;
  const float radius = s.radius_mm();
  view.view = view_matrix(camera);
  view.eye = (camera.target + camera.distance_mm * camera.direction.normalized()).cast<float>();
  const double away = (view.eye - s.centre()).norm();
  view.projection = projection_matrix(camera, double(settings.width) / settings.height,
                                      std::max(2.0, away - radius), away + radius);
  view.view_projection = view.projection * view.view;
  view.lights = lights_for(camera);
  view.shadow = shadow_matrix(view.lights, s.centre(), radius);
  view.shadows = settings.shadows;
  view.face_closed_off = opaque_face;
  view.skin_opacity = std::clamp(settings.skin_opacity, 0.0, 1.0);
  view.height = settings.height;
  view.field_of_view_deg = camera.field_of_view_deg;
  view.lip_y = 0;
  view.at_rest = 1;
  bool has_teeth = false;
  for (const auto& drawable : s.drawables) {
    const auto role = drawable.part->role;
    if (role == Role::mandible) {
      const Eigen::Vector3d c = drawable.centre.cast<double>();
      const double moved_mm = (s.X_CM * c - c).norm();
      view.at_rest = static_cast<float>(std::exp(-0.5 * moved_mm * moved_mm / 9));
    }
    if (!is_teeth(role) && !(role == Role::mandible && !has_teeth)) continue;
    if (is_teeth(role) && !has_teeth) view.lip_y = std::numeric_limits<float>::infinity();
    has_teeth = has_teeth || is_teeth(role);
    for (const auto& v : drawable.part->mesh.vertices)
      view.lip_y = std::min(view.lip_y, static_cast<float>(v.y()));
  }

  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glFrontFace(GL_CCW);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  if (settings.shadows) s.draw_shadow_map(items, view.shadow);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  glViewport(0, 0, settings.width, settings.height);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (!settings.transparent_background) {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    s.programs.background.use();
    glBindVertexArray(s.no_attributes);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glEnable(GL_DEPTH_TEST);
  }
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, s.skin_table);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, s.shadow_map.texture());

  // The face hides most of the rest: drawn first, it spares the shading of what lies under it.
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.is_face() > b.is_face(); });
  for (const auto& item : items)
    if (item.opacity >= 1) s.draw_item(item, view);
  // Blending works on colours multiplied by alpha, so that an empty background stays exact.
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  if (settings.contacts) s.draw_contacts(view, !opaque_face);

  // Far to near, the face last; of each only its front layer.
  std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) {
    if (a.is_face() != b.is_face()) return b.is_face();
    return (a.drawable->centre - view.eye).norm() > (b.drawable->centre - view.eye).norm();
  });
  for (const auto& item : items) {
    if (item.opacity >= 1) continue;
    s.draw_depth(item, view);
    glDepthFunc(GL_EQUAL);
    glEnable(GL_BLEND);
    s.draw_item(item, view);
    glDisable(GL_BLEND);
    glDepthFunc(GL_LESS);
  }
  glBindVertexArray(0);
  glUseProgram(0);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
}

Image SceneRenderer::picture(const Camera& camera, const PictureSettings& settings) {
  auto& s = *state_;
  GLint before = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
  if (!s.resolved || s.resolved->width() != settings.width ||
      s.resolved->height() != settings.height) {
    s.resolved.reset();
    s.resolved.emplace(settings.width, settings.height, 1);
    s.sampled.reset();
  }
  if (settings.samples <= 1) {
    s.resolved->bind();
    draw(camera, settings);
  } else {
    if (!s.sampled || s.samples_asked != settings.samples) {
      s.sampled.reset();
      s.sampled.emplace(settings.width, settings.height, settings.samples);
      s.samples_asked = settings.samples;
    }
    s.sampled->bind();
    draw(camera, settings);
    s.sampled->resolve_to(s.resolved->name());
  }
  Image image = s.resolved->read();
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
  if (settings.transparent_background)
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      const int a = image.rgba[i + 3];
      if (a == 0 || a == 255) continue;
      for (std::size_t k = i; k < i + 3; ++k)
        image.rgba[k] = static_cast<std::uint8_t>(std::min(255, (image.rgba[k] * 255 + a / 2) / a));
    }
  else
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

}  // namespace condyle
