#include "render/scene/face_shape.h"

#include <algorithm>

#include "render/mesh/vertex_normals.h"
#include "render/scene/scene_renderer.h"

namespace condyle {
namespace {

/// The first face; null without one.
const Part* face_among(std::span<const Part> parts) {
  const auto face = std::find_if(parts.begin(), parts.end(),
                                 [](const Part& part) { return part.role == Role::face; });
  return face == parts.end() ? nullptr : &*face;
}

}  // namespace

std::vector<Eigen::Vector3f> float_positions(const TriMesh& mesh) {
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(mesh.vertices.size());
  for (const auto& v : mesh.vertices) positions.push_back(v.cast<float>());
  return positions;
}

bool shows_life(std::span<const Part> parts, const PictureSettings& settings) {
  const Part* face = face_among(parts);
  if (!settings.life || settings.before_operation || !face || face->mesh.empty()) return false;
  const auto own = settings.part_opacity.find(face->name);
  const double opacity =
      settings.skin_opacity * (own == settings.part_opacity.end() ? 1 : own->second);
  const auto cuts = [&](const std::vector<std::string>& list) {
    return list.empty() || std::find(list.begin(), list.end(), face->name) != list.end();
  };
  const bool cut = (settings.clip && cuts(settings.clip->parts)) ||
                   (settings.cut_away && cuts(settings.cut_away->parts));
  return opacity > nearly_opaque && !cut;
}

std::string life_note(std::span<const Part> parts, const PictureSettings& settings) {
  if (!shows_life(parts, settings))
    return "look only: only an opaque, uncut face shows life, so these pictures have none";
  const TriMesh& mesh = face_among(parts)->mesh;
  const std::string lacks =
      LivingFace(parts, float_positions(mesh), mesh.triangles, settings.life->nose_tip).shortfall();
  return "look only: blinks, gaze, pupils, breathing and the head's extension are in the pictures "
         "alone" +
         (lacks.empty() ? "" : "; " + lacks);
}

std::string lids_note(std::span<const Part> parts) {
  const Part* face = face_among(parts);
  if (!face) return {};
  const TriMesh& mesh = face->mesh;
  const LivingFace living(parts, float_positions(mesh), mesh.triangles, std::nullopt);
  const std::string lacks = living.lids_shortfall(), side = living.open_side();
  if (lacks.empty()) return {};
  return "expressions do not move the " + (side.empty() ? "" : side + " ") + "lids: " + lacks;
}

void FaceShape::place(std::vector<Eigen::Vector3f> places) {
  places_ = std::move(places);
  sent_.reset();
}

void FaceShape::send(std::span<const Part> parts, std::span<Drawable> drawables,
                     const PictureSettings& settings, const FaceMoment& moment) {
  const auto face = std::find_if(drawables.begin(), drawables.end(), [](const Drawable& drawable) {
    return drawable.part->role == Role::face;
  });
  if (face == drawables.end()) return;
  Look look{.folds = settings.folds};
  if (shows_life(parts, settings)) {
    look.life = settings.life;
    look.signs = life_signs(moment.time_s, moment.X_CM);
    look.signs->lids = with_blink(moment.lids, look.life->lids * look.signs->lids);
  } else if (moment.lids.any()) {
    look.signs = LifeSigns{.lids = moment.lids, .alive = false};
  }
  if (sent_ ? *sent_ == look : places_.empty() && !look.signs) return;
  const TriMesh& rest = face->part->mesh;
  Drawable::FaceLook drawn{.folded = look.folds};
  const bool moves_lids = look.signs.has_value(), moved_face = !places_.empty();
  const LifeSigns signs = look.signs.value_or(LifeSigns{.alive = false});
  std::vector<std::vector<Eigen::Vector3f>> lashes(parts.size());
  if (moves_lids || moved_face) {
    const LivingFace& own = living(parts, *face, look);
    drawn.alive = [&](std::span<Eigen::Vector3f> places) {
      auto moved =
          own.move_face(look.life.value_or(Life{}), signs, look.folds && moved_face, places);
      // Eyes before an operation are as they were, beside skin that lies where it did.
      if (!settings.before_operation) lashes = std::move(moved.lashes);
      return std::move(moved.shades);
    };
  }
  if (moves_lids)
    // The skin of a closed lid is unfolded, not drawn out to streaks.
    drawn.relief = [&](std::span<Eigen::Vector3f> places) {
      living_->move_lids(signs, false, places);
    };
  face->move_face(places_.empty() ? float_positions(rest) : places_, drawn, normals_);
  const bool moves_eyes = moves_lids || std::any_of(lashes.begin(), lashes.end(),
                                                    [](const auto& of) { return !of.empty(); });
  if (moves_eyes || eyes_moved_) send_eyes(drawables, signs, lashes);
  eyes_moved_ = moves_eyes;
  sent_ = look;
}

LivingFace& FaceShape::living(std::span<const Part> parts, const Drawable& face, const Look& look) {
  if (!living_ || (look.life && nose_tip_ != look.life->nose_tip)) {
    nose_tip_ = look.life ? look.life->nose_tip : std::nullopt;
    living_.emplace(parts, float_positions(face.part->mesh), face.triangles(), nose_tip_);
  }
  return *living_;
}

void FaceShape::send_eyes(std::span<Drawable> drawables, const LifeSigns& signs,
                          std::span<const std::vector<Eigen::Vector3f>> lashes) {
  ++eyes_number_;
  for (std::size_t i = 0; i < drawables.size(); ++i) {
    if (!living_->has_eyes(i)) continue;
    const TriMesh& mesh = drawables[i].part->mesh;
    auto& [places, normals] = eyes_[i];
    places = float_positions(mesh);
    vertex_normals(places, mesh.triangles, normals);
    living_->move_eyes(i, signs, lashes[i], places, normals);
    drawables[i].mesh.send_shape(places, normals);
  }
}

void FaceShape::send_eyes_again(std::size_t drawable, GpuMesh& mesh, long& sent) const {
  const auto shape = eyes_.find(drawable);
  if (sent == eyes_number_ || shape == eyes_.end()) return;
  mesh.send_shape(shape->second.places, shape->second.normals);
  sent = eyes_number_;
}

}  // namespace condyle
