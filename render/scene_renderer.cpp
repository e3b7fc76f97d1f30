#include "render/scene_renderer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "render/drawable.h"
#include "render/framebuffer.h"
#include "render/passes.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double nearly_opaque = 0.999, nearly_hidden = 0.004;
constexpr float opening_room_mm = 45;  // beyond the box at rest, for an open mouth

Eigen::Matrix4f matrix_of(const Pose& pose) {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = pose.R.toRotationMatrix().cast<float>();
  matrix.topRightCorner<3, 1>() = pose.t.cast<float>();
  return matrix;
}

/// Front of the teeth, else of the jaws: where the mouth begins, mm.
float front_of_mouth(std::span<const Drawable> drawables) {
  float teeth = std::numeric_limits<float>::infinity(), jaws = teeth;
  for (const auto& drawable : drawables) {
    const auto role = drawable.part->role;
    if (drawable.box.isEmpty()) continue;
    if (is_teeth(role)) teeth = std::min(teeth, drawable.box.min().y());
    if (role == Role::mandible || role == Role::maxilla)
      jaws = std::min(jaws, drawable.box.min().y());
  }
  return std::isfinite(teeth) ? teeth : std::isfinite(jaws) ? jaws : 0;
}

}  // namespace

struct SceneRenderer::State {
  std::span<const Part> parts;
  Passes passes;
  std::vector<Drawable> drawables;
  Eigen::AlignedBox3f box;  // of all parts at rest
  float mouth_y;
  GpuPoints contacts;
  // Of the last frame:
  std::vector<Pose> poses;  // of each drawable
  Pose X_CM;
  Eigen::AlignedBox3f reached;  // `box` and the free parts where they are
  bool face_moved = false;
  std::vector<Eigen::Vector3f> normals;  // kept for its memory
  // Kept from picture to picture of one size:
  std::optional<Framebuffer> sampled, resolved;
  int samples_asked = 0;
  float map_low = 0, map_high = 1;  // values are kept within

  explicit State(std::span<const Part> all)
      : parts(all), drawables(make_drawables(all)), mouth_y(front_of_mouth(drawables)) {
    for (const auto& drawable : drawables) box.extend(drawable.box);
    if (box.isEmpty()) box = Eigen::AlignedBox3f(Eigen::Vector3f::Zero());
    place({});
  }

  void place(const BodyPoses& at);

  std::vector<DrawItem> items(const PictureSettings& settings);
  PictureView view(const Camera& camera, const PictureSettings& settings,
                   std::span<const DrawItem> items) const;
  float at_rest(std::span<const DrawItem> items) const;
};

std::vector<DrawItem> SceneRenderer::State::items(const PictureSettings& settings) {
  std::vector<DrawItem> found;
  for (std::size_t i = 0; i < drawables.size(); ++i) {
    auto& drawable = drawables[i];
    const auto& part = *drawable.part;
    double opacity = part.role == Role::face ? settings.skin_opacity : 1;
    if (const auto own = settings.part_opacity.find(part.name); own != settings.part_opacity.end())
      opacity *= own->second;
    if (part.mesh.empty() || !(opacity >= nearly_hidden)) continue;
    found.push_back({&drawable, opacity > nearly_opaque ? 1.0 : opacity, matrix_of(poses[i])});
  }
  return found;
}

void SceneRenderer::State::place(const BodyPoses& at) {
  X_CM = at.X_CM;
  poses.clear();
  reached = box;
  for (std::size_t i = 0; i < drawables.size(); ++i) {
    poses.push_back(pose_of(parts, i, at));
    if (body_of(parts[i].role) != Body::free || drawables[i].box.isEmpty()) continue;
    reached.extend(DrawItem{&drawables[i], 1, matrix_of(poses[i])}.box());
  }
}

/// How far the jaw is from the place where its shade was baked: 1 there, 0 far off, and where
/// either jaw is not drawn.
float SceneRenderer::State::at_rest(std::span<const DrawItem> items) const {
  const auto drawn = [&](Body body) {
    return std::any_of(items.begin(), items.end(), [&](const DrawItem& item) {
      return body_of(item.role()) == body && collides(item.role());
    });
  };
  const auto exists = [&](Body body) {
    return std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
      return body_of(part.role) == body && collides(part.role) && !part.mesh.empty();
    });
  };
  for (const Body body : {Body::cranium, Body::mandible})
    if (exists(body) && !drawn(body)) return 0;
  for (const auto& drawable : drawables) {
    if (body_of(drawable.part->role) != Body::mandible || drawable.box.isEmpty()) continue;
    const Eigen::Vector3d centre = drawable.box.center().cast<double>();
    const double moved_mm = (X_CM * centre - centre).norm();
    return static_cast<float>(std::exp(-moved_mm * moved_mm / 20));
  }
  return 1;
}

PictureView SceneRenderer::State::view(const Camera& camera, const PictureSettings& settings,
                                       std::span<const DrawItem> items) const {
  const float radius = 0.5f * reached.diagonal().norm() + opening_room_mm;
  PictureView v;
  v.view = view_matrix(camera);
  v.eye = (camera.target + camera.distance_mm * camera.direction.normalized()).cast<float>();
  const double away = (v.eye - reached.center()).norm();
  v.projection = projection_matrix(camera, static_cast<double>(settings.width) / settings.height,
                                   std::max({2.0, away - radius, camera.near_mm}),
                                   std::max(away + radius, camera.near_mm + 1));
  v.view_projection = v.projection * v.view;
  v.lights = lights_for(camera);
  auto moving = reached;
  moving.min().z() -= opening_room_mm;
  moving.min().array() -= 3;
  moving.max().array() += 3;
  v.shadow = shadow_matrix(v.lights, moving);
  v.pixels_per_unit = static_cast<float>(
      settings.height / 2.0 / std::tan(camera.field_of_view_deg * std::numbers::pi / 360));
  v.shadows = settings.shadows;
  v.may_cull = away > radius + 5;
  v.skin_opacity = static_cast<float>(std::clamp(settings.skin_opacity, 0.0, 1.0));
  v.at_rest = at_rest(items);
  v.lips_y = mouth_y;
  return v;
}

SceneRenderer::SceneRenderer(std::span<const Part> parts)
    : state_(std::make_unique<State>(parts)) {}

SceneRenderer::~SceneRenderer() = default;

std::pair<Eigen::Vector3d, Eigen::Vector3d> SceneRenderer::bounds() const {
  return {state_->box.min().cast<double>(), state_->box.max().cast<double>()};
}

void SceneRenderer::update(const FrameState& frame) {
  auto& s = *state_;
  s.place(frame.poses());
  for (auto& drawable : s.drawables) {
    if (drawable.part->role != Role::face) continue;
    const auto& rest = drawable.part->mesh.vertices;
    if (frame.face.size() == rest.size()) {
      drawable.move_face(frame.face, s.normals);
    } else if (s.face_moved) {
      std::vector<Eigen::Vector3f> positions;
      for (const auto& v : rest) positions.push_back(v.cast<float>());
      drawable.move_face(positions, s.normals);
    }
    s.face_moved = frame.face.size() == rest.size();
    break;
  }
  std::vector<Eigen::Vector3f> points;
  for (const auto& pair : frame.contacts.pairs)
    for (const auto& contact : pair.contacts) points.push_back(contact.point.cast<float>());
  s.contacts.send(points);
}

void SceneRenderer::set_colour_map(const ColourMap& map) {
  state_->map_low = map.low() - 1;
  state_->map_high = map.high() + 1;
  state_->passes.set_colour_map(map);
}

void SceneRenderer::set_finer(const std::string& name, const TriMesh& surface,
                              std::span<const Eigen::Vector3f> normals) {
  for (auto& drawable : state_->drawables)
    if (drawable.part->name == name) drawable.set_finer(surface, normals);
}

void SceneRenderer::color_part(const std::string& name, std::span<const float> values) {
  auto& s = *state_;
  for (auto& drawable : s.drawables) {
    if (drawable.part->name != name) continue;
    assert(values.empty() ||
           values.size() ==
               (drawable.finer ? drawable.finer_vertices : drawable.part->mesh.vertices.size()));
    // Kept near the range, so that the way from a far vertex to a near one passes through it.
    std::vector<float> kept(values.begin(), values.end());
    for (float& value : kept)
      value = std::isnan(value) ? s.map_high : std::clamp(value, s.map_low, s.map_high);
    drawable.mapped = !kept.empty();
    (drawable.finer ? *drawable.finer : drawable.mesh).send_values(kept);
  }
}

void SceneRenderer::draw(const Camera& camera, const PictureSettings& settings) {
  auto& s = *state_;
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  const auto items = s.items(settings);
  auto view = s.view(camera, settings, items);
  view.opaque_face = std::any_of(items.begin(), items.end(), [](const DrawItem& item) {
    return item.role() == Role::face && item.opaque();
  });

  // Whoever drew before may have left anything.
  for (const GLenum off : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB})
    glDisable(off);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_MULTISAMPLE);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glFrontFace(GL_CCW);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);

  if (settings.shadows) s.passes.shadow_map(items, view);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  glViewport(0, 0, settings.width, settings.height);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (!settings.transparent_background) s.passes.background();
  s.passes.opaque(items, view);
  if (settings.contacts) s.passes.contacts(s.contacts, view, !view.opaque_face);
  s.passes.translucent(items, view);

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
    s.sampled.reset();
    s.resolved.reset();
    s.resolved.emplace(settings.width, settings.height, 1);
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
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    auto& alpha = image.rgba[i + 3];
    if (!settings.transparent_background) alpha = 255;
    if (alpha == 0 || alpha == 255) continue;
    // Drawn multiplied by alpha; an image has straight alpha.
    for (std::size_t k = i; k < i + 3; ++k)
      image.rgba[k] =
          static_cast<std::uint8_t>(std::min(255, (image.rgba[k] * 255 + alpha / 2) / alpha));
  }
  return image;
}

}  // namespace condyle
