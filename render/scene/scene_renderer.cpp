#include "render/scene/scene_renderer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "render/face/drawn_face.h"
#include "render/face/hide_protruding_bone.h"
#include "render/face/lashes.h"
#include "render/scene/drawable.h"
#include "render/scene/face_shape.h"
#include "render/scene/overlay_passes.h"
#include "render/scene/passes.h"
#include "render/scene/picture_target.h"
#include "render/scene/section_anatomy.h"
#include "render/scene/tongue_shape.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double nearly_hidden = 0.004;
constexpr float opening_room_mm = 45;  // margin below the box at rest, for an open mouth

Eigen::Matrix4f matrix_of(const Pose& pose) {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = pose.R.toRotationMatrix().cast<float>();
  matrix.topRightCorner<3, 1>() = pose.t.cast<float>();
  return matrix;
}

/// Whether a list names the part; an empty list means `fallback`.
bool names(const std::vector<std::string>& list, const std::string& name, bool fallback = false) {
  return list.empty() ? fallback : std::find(list.begin(), list.end(), name) != list.end();
}

/// Front of the teeth, else of the jaws: the anterior end of the mouth, mm.
float front_of_mouth(std::span<const Drawable> drawables) {
  float teeth = std::numeric_limits<float>::infinity(), jaws = teeth;
  for (const auto& drawable : drawables) {
    const auto role = drawable.part->role;
    if (drawable.box.isEmpty()) continue;
    if (is_teeth(role)) teeth = std::min(teeth, drawable.box.min().y());
    if (role == Role::mandible || role == Role::maxilla || is_piece(role))
      jaws = std::min(jaws, drawable.box.min().y());
  }
  return std::isfinite(teeth) ? teeth : std::isfinite(jaws) ? jaws : 0;
}

}  // namespace

struct SceneRenderer::State {
  std::shared_ptr<const PreparedParts> patient;
  std::span<const Part> parts;
  Passes passes;
  OverlayPasses overlays;
  std::shared_ptr<const BeforeOperation> operation;
  std::vector<Drawable> drawables;  // of the parts, then of those that the operation removed
  Eigen::AlignedBox3f box;          // of all parts at rest
  float mouth_y;
  // For eye drawables by number, once the skin was not opaque: the balls, and the lashes, which
  // belong to the skin.
  struct PartedEyes {
    std::optional<Drawable> balls, lashes;
    long sent = 0;  // shape of the lashes
  };
  std::map<std::size_t, PartedEyes> parted_eyes;
  // For cranial drawables by number and whether they are in place, once the skin was opaque:
  // see hide_protruding_bone; none where nothing is left out.
  std::map<std::pair<std::size_t, bool>, std::optional<Drawable>> beneath;
  std::optional<MouthCavity> mouth;               // from the first picture of an opaque face on
  std::optional<SectionAnatomy> section_anatomy;  // from the first section on
  TongueShape tongue_shape;
  GpuPoints contacts;
  // State of the last frame:
  std::vector<Pose> poses;  // of each drawable
  BodyId lower_jaw;
  Pose X_CM;                    // of the lower jaw
  Eigen::AlignedBox3f reached;  // `box` and the present boxes of other bodies
  bool face_moved = false;
  double time_s = 0;
  LidClosure lids;
  FaceShape face_shape;
  std::vector<Eigen::Vector3f> contact_points;
  PictureTarget target;
  float map_low = 0, map_high = 1;  // values are clamped to this range

  State(std::shared_ptr<const PreparedParts> all, std::shared_ptr<const BeforeOperation> before,
        std::vector<Drawable> made)
      : patient(std::move(all)),
        parts(patient->patient()),
        operation(std::move(before)),
        drawables(std::move(made)),
        mouth_y(front_of_mouth(present())),
        lower_jaw(lower_jaw_of(parts)) {
    for (const auto& drawable : drawables) box.extend(drawable.box);
    if (box.isEmpty()) box = Eigen::AlignedBox3f(Eigen::Vector3f::Zero());
    place({});
  }

  std::span<Drawable> present() { return std::span(drawables).first(parts.size()); }
  void place(const BodyPoses& at);
  Drawable* first_face();
  /// The part whose opacity a drawable has; null where it is not there.
  const std::string* shown_as(std::size_t drawable, bool before) const;

  std::vector<DrawItem> items(const PictureSettings& settings);
  void part_lashes_from(std::vector<DrawItem>& items);
  void keep_beneath_skin(std::vector<DrawItem>& items);
  PictureView view(const Camera& camera, const PictureSettings& settings,
                   std::span<const DrawItem> items) const;
  float at_rest(std::span<const DrawItem> items) const;
  std::optional<DrawItem> mouth_cavity(std::span<const DrawItem> items, const PictureView& view);
  std::span<const SectionSolid> section_solids(const PictureView& view);
  bool leaves_ghost(const DrawItem& item, const Ghost& ghost) const;
};

std::vector<DrawItem> SceneRenderer::State::items(const PictureSettings& settings) {
  std::vector<DrawItem> found;
  for (std::size_t i = 0; i < drawables.size(); ++i) {
    auto& drawable = drawables[i];
    const auto& part = *drawable.part;
    const std::string* name = shown_as(i, settings.before_operation);
    if (!name) continue;
    double opacity = part.role == Role::face ? settings.skin_opacity : 1;
    if (const auto own = settings.part_opacity.find(*name); own != settings.part_opacity.end())
      opacity *= own->second;
    if (part.mesh.empty() || !(opacity >= nearly_hidden)) continue;
    DrawItem item{&drawable, opacity > nearly_opaque ? 1.0 : opacity, matrix_of(poses[i])};
    item.clipped = settings.clip && names(settings.clip->parts, part.name, true);
    item.holed =
        settings.cut_away && names(settings.cut_away->parts, part.name, part.role == Role::face);
    found.push_back(item);
  }
  part_lashes_from(found);
  keep_beneath_skin(found);
  return found;
}

const std::string* SceneRenderer::State::shown_as(std::size_t drawable, bool before) const {
  if (drawable >= parts.size())
    return before ? &operation->removed[drawable - parts.size()].shown_as : nullptr;
  const std::string& name = parts[drawable].name;
  return before && operation && names(operation->added, name) ? nullptr : &name;
}

void SceneRenderer::State::keep_beneath_skin(std::vector<DrawItem>& items) {
  const auto face = std::find_if(items.begin(), items.end(), [](const DrawItem& item) {
    return item.role() == Role::face && item.opaque() && !item.cut();
  });
  if (face == items.end()) return;
  for (auto& item : items) {
    const bool bone = item.role() == Role::skull || item.role() == Role::maxilla;
    if (!bone || item.drawable->mapped || !item.opaque() || item.cut()) continue;
    const auto number = static_cast<std::size_t>(item.drawable - drawables.data());
    const bool in_place = item.role() == Role::skull && item.model.isIdentity(0);
    auto [found, fresh] = beneath.try_emplace({number, in_place});
    if (fresh) {
      const auto kept =
          hide_protruding_bone(item.drawable->part->mesh, face->drawable->part->mesh, in_place);
      if (kept) found->second.emplace(piece_of(*item.drawable, *kept));
    }
    if (found->second) item.drawable = &*found->second;
  }
}

/// Lashes have the opacity and cuts of the skin that they grow from.
void SceneRenderer::State::part_lashes_from(std::vector<DrawItem>& items) {
  if (std::none_of(parts.begin(), parts.end(),
                   [](const Part& part) { return part.role == Role::face; }))
    return;
  const auto skin = std::find_if(items.begin(), items.end(),
                                 [](const DrawItem& item) { return item.role() == Role::face; });
  const DrawItem* face = skin == items.end() ? nullptr : &*skin;
  if (face && face->opaque() && !face->cut()) return;
  std::vector<DrawItem> all;
  for (const auto& item : items) {
    if (item.role() != Role::eyes || item.drawable->mapped) {
      all.push_back(item);
      continue;
    }
    const auto number = static_cast<std::size_t>(item.drawable - drawables.data());
    auto [eyes, fresh] = parted_eyes.try_emplace(number);
    auto& [balls, lashes, sent] = eyes->second;
    if (fresh) {
      const EyePieces pieces = part_lashes(item.drawable->part->mesh);
      if (!pieces.eyes.empty()) balls.emplace(piece_of(*item.drawable, pieces.eyes));
      if (!pieces.lashes.empty()) lashes.emplace(piece_of(*item.drawable, pieces.lashes));
    }
    if (!lashes) {
      all.push_back(item);
      continue;
    }
    if (balls) all.push_back(item), all.back().drawable = &*balls;
    if (!face) continue;
    face_shape.send_eyes_again(number, lashes->mesh, sent);
    DrawItem strands = item;
    strands.drawable = &*lashes;
    strands.opacity = std::min(item.opacity, face->opacity);
    strands.clipped |= face->clipped;
    strands.holed |= face->holed;
    all.push_back(strands);
  }
  items = std::move(all);
}

void SceneRenderer::State::place(const BodyPoses& at) {
  X_CM = at[lower_jaw];
  poses.clear();
  reached = box;
  for (std::size_t i = 0; i < drawables.size(); ++i) {
    const Part& part = *drawables[i].part;
    poses.push_back(pose_of(part, at));
    if (part.body == cranium_body || part.body == lower_jaw || drawables[i].box.isEmpty()) continue;
    reached.extend(DrawItem{&drawables[i], 1, matrix_of(poses[i])}.box());
  }
  tongue_shape.send(drawables, poses);
}

Drawable* SceneRenderer::State::first_face() {
  const auto face = std::find_if(drawables.begin(), drawables.end(), [](const Drawable& drawable) {
    return drawable.part->role == Role::face;
  });
  return face == drawables.end() ? nullptr : &*face;
}

/// Distance of the jaw from the pose of its baked shade: 1 there, 0 far off, and where either jaw
/// is not drawn.
float SceneRenderer::State::at_rest(std::span<const DrawItem> items) const {
  const auto drawn = [&](BodyId body) {
    return std::any_of(items.begin(), items.end(), [&](const DrawItem& item) {
      return item.drawable->part->body == body && collides(item.role());
    });
  };
  const auto exists = [&](BodyId body) {
    return std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
      return part.body == body && collides(part.role) && !part.mesh.empty();
    });
  };
  for (const BodyId body : {cranium_body, lower_jaw})
    if (exists(body) && !drawn(body)) return 0;
  for (const auto& drawable : drawables) {
    if (drawable.part->body != lower_jaw || drawable.box.isEmpty()) continue;
    const Eigen::Vector3d centre = drawable.box.center().cast<double>();
    const double moved_mm = (X_CM * centre - centre).norm();
    return static_cast<float>(std::exp(-moved_mm * moved_mm / 20));
  }
  return 1;
}

/// The lining of the mouth, where the picture shows a section of an opaque face.
std::optional<DrawItem> SceneRenderer::State::mouth_cavity(std::span<const DrawItem> items,
                                                           const PictureView& view) {
  const auto face = std::find_if(items.begin(), items.end(), [](const DrawItem& item) {
    return item.role() == Role::face && item.opaque();
  });
  if (face == items.end() || (face->clipped && !shows_caps(view))) return std::nullopt;
  const MouthLining* lining = patient->lining();
  if (!lining) return std::nullopt;
  if (!mouth) mouth.emplace(*lining, *face->drawable);
  DrawItem item{&mouth->place(face->drawable->mesh, X_CM), 1, Eigen::Matrix4f::Identity()};
  item.clipped = face->clipped;
  item.holed = face->holed;
  return item;
}

std::span<const SectionSolid> SceneRenderer::State::section_solids(const PictureView& view) {
  if (!view.sectioned) return {};
  if (!section_anatomy) section_anatomy.emplace(parts);
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].role == Role::tongue) return section_anatomy->place(poses[i]);
  return section_anatomy->place(X_CM);
}

bool SceneRenderer::State::leaves_ghost(const DrawItem& item, const Ghost& ghost) const {
  if (!ghost.parts.empty()) return names(ghost.parts, item.drawable->part->name);
  if (item.role() == Role::face) return face_moved;
  constexpr float moved = 1e-3f;
  return !item.model.isApprox(Eigen::Matrix4f::Identity(), moved);
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
  v.width = settings.width;
  v.height = settings.height;
  v.lights = lights_for(camera);
  auto moving = reached;
  moving.min().z() -= opening_room_mm;
  moving.min().array() -= 3;
  moving.max().array() += 3;
  v.shadow = shadow_matrix(v.lights, moving);
  v.pixels_per_unit = static_cast<float>(
      settings.height / 2.0 / std::tan(camera.field_of_view_deg * std::numbers::pi / 360));
  v.shadows = settings.shadows;
  v.light = settings.backdrop == Backdrop::light;
  if (!settings.transparent) v.backdrop = settings.backdrop;
  v.coarse = settings.coarse;
  v.may_cull = away > radius + 5;
  v.skin_opacity = static_cast<float>(std::clamp(settings.skin_opacity, 0.0, 1.0));
  v.at_rest = at_rest(items);
  v.lips_y = mouth_y;
  v.away = static_cast<float>(camera.distance_mm);
  if (settings.clip) {
    v.cut_normal = settings.clip->normal.normalized().cast<float>();
    v.clip_plane << -v.cut_normal, v.cut_normal.dot(settings.clip->point.cast<float>());
    v.capped = settings.clip->capped;
  } else if (settings.cut_away) {
    v.cut_normal = (v.eye - settings.cut_away->center.cast<float>()).normalized();
  }
  if (settings.cut_away)
    v.cut_ball << settings.cut_away->center.cast<float>(),
        static_cast<float>(settings.cut_away->radius_mm);
  if (settings.mapped_up_to) v.mapped_up_to = *settings.mapped_up_to;
  return v;
}

SceneRenderer::SceneRenderer(std::span<const Part> patient,
                             std::shared_ptr<const BeforeOperation> operation) {
  auto prepared = std::make_shared<const PreparedParts>(patient);
  std::vector<const Part*> drawn;
  for (const auto& part : patient) drawn.push_back(&prepared->drawn(part));
  auto drawables = make_drawables(drawn, prepared->lining());
  if (operation) {
    // Their shade is their own: the present state does not lie in it.
    std::vector<const Part*> removed;
    for (const RemovedPart& each : operation->removed) removed.push_back(&each.part);
    for (Drawable& drawable : make_drawables(removed, nullptr))
      drawables.push_back(std::move(drawable));
  }
  state_ = std::make_unique<State>(std::move(prepared), std::move(operation), std::move(drawables));
}

SceneRenderer::SceneRenderer(const SceneRenderer& other)
    : state_(std::make_unique<State>(other.state_->patient, other.state_->operation,
                                     drawables_like(other.state_->drawables))) {}

SceneRenderer::~SceneRenderer() = default;

std::pair<Eigen::Vector3d, Eigen::Vector3d> SceneRenderer::bounds() const {
  return {state_->box.min().cast<double>(), state_->box.max().cast<double>()};
}

void SceneRenderer::update(const FrameState& frame) {
  auto& s = *state_;
  s.time_s = frame.time_s;
  s.lids = frame.lids;
  s.place(frame.poses);
  if (const Drawable* face = s.first_face()) {
    const auto& rest = face->part->mesh.vertices;
    const DrawnFace* other = s.patient->face_of(*face->part);
    const bool moved = frame.face.size() == (other ? other->given() : rest.size());
    if (moved) {
      s.face_shape.place(other ? other->places(frame.face) : frame.face);
    } else if (s.face_moved) {
      s.face_shape.place(float_positions(face->part->mesh));
    }
    s.face_moved = moved;
  }
  s.contact_points.clear();
  for (const auto& pair : frame.contacts.pairs)
    for (const auto& contact : pair.contacts)
      s.contact_points.push_back(contact.point.cast<float>());
  s.contacts.send(s.contact_points);
}

void SceneRenderer::set_colour_map(const ColourMap& map) {
  state_->map_low = map.low() - 1;
  state_->map_high = map.high() + 1;
  state_->passes.set_colour_map(map);
}

void SceneRenderer::set_finer(const std::string& name, const TriMesh& surface,
                              std::span<const Eigen::Vector3f> normals) {
  for (auto& drawable : state_->present())
    if (drawable.part->name == name) drawable.set_finer(surface, normals);
}

void SceneRenderer::color_part(const std::string& name, std::span<const float> values) {
  auto& s = *state_;
  for (auto& drawable : s.present()) {
    if (drawable.part->name != name) continue;
    std::vector<float> kept(values.begin(), values.end());
    // Clamped near the range, so that the interpolation from a far vertex to a near one passes
    // through it; not at its very end, where the limit of the coloured area would follow the
    // triangles.
    const float above = s.map_high + 1;
    for (float& value : kept)
      value = std::isnan(value) ? above : std::clamp(value, s.map_low, above);
    if (const auto* face = s.patient->face_of(*drawable.part); face && !kept.empty())
      kept = face->values(kept);
    assert(kept.empty() || kept.size() == (drawable.finer ? drawable.finer_vertices
                                                          : drawable.part->mesh.vertices.size()));
    drawable.mapped = !kept.empty();
    (drawable.finer ? *drawable.finer : drawable.mesh).send_values(kept);
  }
}

void SceneRenderer::set_lines(const std::string& name, const LineSet& lines) {
  state_->overlays.set_lines(name, lines);
}

void SceneRenderer::set_sheet(const std::string& name, const GlassSheet& sheet) {
  state_->overlays.set_sheet(name, sheet);
}

void SceneRenderer::set_body(const std::string& name, const FibreBody& body) {
  state_->overlays.set_body(name, body);
}

DrawnBox SceneRenderer::drawn_box(const Camera& camera, const PictureSettings& settings) const {
  auto& s = *state_;
  s.face_shape.send(s.parts, s.present(), settings, {s.time_s, s.X_CM, s.lids});
  const auto items = s.items(settings);
  const auto view = s.view(camera, settings, items);
  PictureBounds bounds(settings.width, settings.height, view.view_projection);
  for (const auto& item : items) {
    const bool coarse = settings.coarse && settings.wireframe.empty();
    for (const auto& piece : item.surface(coarse).pieces) bounds.add(piece.box, item.model);
    if (settings.ghost && s.leaves_ghost(item, *settings.ghost))
      bounds.add(item.drawable->box, Eigen::Matrix4f::Identity());
  }
  if (settings.contacts) Passes::add_contacts(s.contact_points, bounds, view);
  s.overlays.add_bounds(bounds, view);
  return bounds.box(drawn_air);
}

void SceneRenderer::draw(const Camera& camera, const PictureSettings& settings,
                         const std::optional<DrawnBox>& within) {
  auto& s = *state_;
  s.face_shape.send(s.parts, s.present(), settings, {s.time_s, s.X_CM, s.lids});
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  const auto items = s.items(settings);
  auto view = s.view(camera, settings, items);
  view.opaque_face = std::any_of(items.begin(), items.end(), [](const DrawItem& item) {
    return item.role() == Role::face && item.opaque() && !item.cut();
  });
  for (const auto& item : items) {
    if (item.role() != Role::face || !item.opaque() || item.clipped) continue;
    view.dark_mouth = true;
    if (item.holed) view.window_ball = view.cut_ball;
  }
  if (settings.mapped_up_to)
    for (const auto& item : items)
      if (item.drawable->mapped && item.drawable->finer) item.drawable->dress_finer();

  // Other drawing may have changed the state.
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
  const auto column = [&](double x) {
    return static_cast<int>(std::lround(std::clamp(x, 0.0, 1.0) * settings.width));
  };
  DrawnBox box = {column(settings.from_x), 0, column(settings.to_x), settings.height};
  if (within) box = box.both(*within);
  view.box = box;
  GLint sample_buffers = 0;
  glGetIntegerv(GL_SAMPLE_BUFFERS, &sample_buffers);
  view.one_sample = sample_buffers == 0;
  glEnable(GL_SCISSOR_TEST);
  glScissor(box.x0, box.y0, box.width(), box.height());
  const auto mouth = s.mouth_cavity(items, view);
  view.sectioned = mouth && mouth->clipped;
  auto surfaces = items;
  if (mouth) surfaces.push_back(*mouth);
  s.passes.opaque(surfaces, view);
  s.overlays.caps(items, view, mouth ? &*s.mouth : nullptr, s.section_solids(view));
  s.passes.background(view);
  if (settings.contacts) s.passes.contacts(s.contacts, view, !view.opaque_face);
  for (const auto& item : items)
    if (settings.ghost && item.role() != Role::face && s.leaves_ghost(item, *settings.ghost))
      s.overlays.ghost(item, *settings.ghost, view);
  s.overlays.bodies(view, settings.clip && settings.clip->parts.empty());
  s.overlays.lines(view, settings.width, settings.height);
  s.overlays.sheets(view);
  s.passes.translucent(items, view);
  // The skin's ghost encloses all the rest.
  for (const auto& item : items)
    if (settings.ghost && item.role() == Role::face && s.leaves_ghost(item, *settings.ghost))
      s.overlays.ghost(item, *settings.ghost, view);
  const bool all_edges = names(settings.wireframe, "*");
  for (const auto& item : items)
    if (all_edges || names(settings.wireframe, item.drawable->part->name))
      s.overlays.wireframe(item, view);

  glDisable(GL_SCISSOR_TEST);
  glBindVertexArray(0);
  glUseProgram(0);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
}

Image SceneRenderer::picture(const Camera& camera, const PictureSettings& settings) {
  auto& s = *state_;
  GLint before = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
  const int finer = std::clamp(settings.supersampling, 1, 4);
  auto drawn = settings;
  drawn.width *= finer;
  drawn.height *= finer;
  drawn.from_x = 0;
  drawn.to_x = 1;
  s.target.fit(drawn.width, drawn.height, drawn.samples, drawn.smooth_edges && drawn.samples <= 1);
  const DrawnBox box = drawn_box(camera, drawn);
  s.target.drawn().bind();
  draw(camera, drawn, box);
  Image image{drawn.width, drawn.height, {}};
  const auto behind = settings.transparent ? std::nullopt : std::optional(settings.backdrop);
  s.target.read(box, behind, true, image.rgba);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
  if (finer > 1) image = averaged(image, finer);
  if (!settings.transparent) return image;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const auto alpha = image.rgba[i + 3];
    if (alpha == 0 || alpha == 255) continue;
    // Drawn premultiplied; an image has straight alpha.
    for (std::size_t k = i; k < i + 3; ++k)
      image.rgba[k] =
          static_cast<std::uint8_t>(std::min(255, (image.rgba[k] * 255 + alpha / 2) / alpha));
  }
  return image;
}

}  // namespace condyle
