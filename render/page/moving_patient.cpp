#include "render/page/moving_patient.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/gltf/shape_keys.h"
#include "engine/mesh/simplify.h"
#include "render/face/drawn_face.h"
#include "render/face/shade_layers.h"
#include "render/mesh/vertex_normals.h"
#include "render/shaders/material.h"

namespace condyle {
namespace {

using Eigen::Vector3f;
using Points = std::vector<Vector3f>;

constexpr int shade_directions = 48, shade_threads = 2;
constexpr float still_mm = 0.02f;  // shifts of the face below this are left out

Points floats(const std::vector<Eigen::Vector3d>& points) {
  Points result;
  result.reserve(points.size());
  for (const auto& p : points) result.push_back(p.cast<float>());
  return result;
}

/// What a viewer switches on and off together.
const char* kind_of(Role role) {
  if (role == Role::face) return "face";
  if (role == Role::eyes) return "eyes";
  if (is_teeth(role)) return "teeth";
  return collides(role) ? "bone" : "mouth";
}

/// Some of the vertices of a surface, renumbered.
struct Selection {
  std::vector<std::size_t> vertices;  // of the whole surface
  std::vector<Eigen::Vector3i> triangles;

  Points of(std::span<const Vector3f> whole) const {
    Points some;
    some.reserve(vertices.size());
    for (const std::size_t v : vertices) some.push_back(whole[v]);
    return some;
  }
};

Selection used_by(std::span<const Eigen::Vector3i> triangles, std::size_t count) {
  Selection selection;
  std::vector<int> number(count, -1);
  for (const auto& t : triangles) {
    Eigen::Vector3i own;
    for (int k = 0; k < 3; ++k) {
      int& n = number[static_cast<std::size_t>(t[k])];
      if (n < 0) {
        n = static_cast<int>(selection.vertices.size());
        selection.vertices.push_back(static_cast<std::size_t>(t[k]));
      }
      own[k] = n;
    }
    selection.triangles.push_back(own);
  }
  return selection;
}

/// A part as drawn: all its vertices at rest, and those that are kept.
struct DrawnPart {
  const Part* part = nullptr;
  Points places, normals, colors;
  Selection kept;
};

/// Darkens colours by the part of the sky that the surface does not see.
void shade(Points& colors, const std::vector<float>& sky) {
  for (std::size_t v = 0; v < colors.size(); ++v) colors[v] *= 0.35f + 0.65f * sky[v];
}

std::vector<DrawnPart> drawn_parts(const PreparedParts& prepared,
                                   const MovingPatientSettings& settings) {
  std::vector<DrawnPart> drawn;
  for (const Part& given : prepared.patient()) {
    const Part& part = prepared.drawn(given);
    DrawnPart each;
    each.part = &part;
    each.places = floats(part.mesh.vertices);
    const MouthLining* lining = prepared.lining();
    const bool lined = lining && part.role == Role::face &&
                       std::none_of(drawn.begin(), drawn.end(), [](const DrawnPart& other) {
                         return other.part->role == Role::face;
                       });
    const auto& triangles = lined ? lining->face : part.mesh.triangles;
    if (lined && lining->cut) even_rim(each.places, lining->rim);
    vertex_normals(each.places, triangles, each.normals);
    each.colors = part.mesh.colors;
    if (each.colors.size() != each.places.size())
      each.colors.assign(each.places.size(), material_of(part.role).color);
    each.kept =
        used_by(coarser(each.places, triangles, settings.most_triangles, settings.simplified_mm),
                each.places.size());
    drawn.push_back(std::move(each));
  }
  std::vector<OcclusionSurface> surfaces;
  const BodyId lower_jaw = lower_jaw_of(prepared.patient());
  for (const DrawnPart& each : drawn) {
    surfaces.push_back({each.places, each.normals, each.part->mesh.triangles});
    set_shade_layers(*each.part, lower_jaw, surfaces.back());
  }
  const auto sky = bake_occlusion(surfaces, shade_directions, shade_threads);
  for (std::size_t p = 0; p < drawn.size(); ++p) shade(drawn[p].colors, sky[p].together);
  return drawn;
}

/// Colours of the mouth's lining: the inner side of the lips, darker towards the throat.
Points lining_colors(const MouthLining& lining) {
  Points colors;
  const std::size_t around = std::max<std::size_t>(1, lining.rim.size());
  const auto rings = static_cast<float>(std::max<std::size_t>(1, lining.rest.size() / around));
  for (std::size_t v = 0; v < lining.rest.size(); ++v) {
    const float deep = static_cast<float>(v / around) / rings;
    const Vector3f mucosa(0.60f, 0.30f, 0.28f);
    colors.push_back((mucosa + lining.tongue[v] * (tongue_color - mucosa)) *
                     (0.85f - 0.55f * deep));
  }
  return colors;
}

/// Builds the scene node by node.
class PatientComposer {
 public:
  PatientComposer(const BodyTree& bodies, std::span<const Part> parts,
                  std::span<const FrameState> frames, const MovingPatientSettings& settings)
      : bodies_(bodies), prepared_(parts), frames_(frames), settings_(settings) {}

  MovingPatient compose() {
    result_.scene.generator = settings_.generator;
    const auto drawn = drawn_parts(prepared_, settings_);
    GltfMotion motion{.name = settings_.motion, .times_s = {}, .tracks = {}};
    for (const FrameState& frame : frames_) motion.times_s.push_back(frame.time_s);
    add_rigid(drawn, motion);
    const auto face = std::find_if(drawn.begin(), drawn.end(), [](const DrawnPart& each) {
      return each.part->role == Role::face;
    });
    if (face != drawn.end()) add_face(*face, motion);
    if (!motion.tracks.empty() || motion.key_times_s.size() > 1)
      result_.scene.motion = std::move(motion);
    return std::move(result_);
  }

 private:
  int add_node(GltfNode node) {
    result_.scene.nodes.push_back(std::move(node));
    return static_cast<int>(result_.scene.nodes.size()) - 1;
  }

  GltfSurface surface_of(const DrawnPart& drawn) const {
    return {.vertices = drawn.kept.of(drawn.places),
            .normals = drawn.kept.of(drawn.normals),
            .colors = drawn.kept.of(drawn.colors),
            .triangles = drawn.kept.triangles,
            .roughness = material_of(drawn.part->role).roughness,
            .two_sided = !is_closed_surface(drawn.kept.triangles)};
  }

  /// A node for each body with surfaces, and its surfaces below it.
  void add_rigid(const std::vector<DrawnPart>& drawn, GltfMotion& motion) {
    for (int b = 0; b < bodies_.size(); ++b) {
      const BodyId body{b};
      const auto carries = [&](const DrawnPart& each) {
        return each.part->body == body && is_rigid(each.part->role);
      };
      if (std::none_of(drawn.begin(), drawn.end(), carries)) continue;
      const int node = add_node({.name = bodies_[body].name, .pose = pose_at(0, body)});
      bool moves = false;
      GltfTrack track{node, {}};
      for (std::size_t f = 0; f < frames_.size(); ++f) {
        track.poses.push_back(pose_at(f, body));
        moves |= !bit_identical(track.poses.back(), track.poses.front());
      }
      if (moves) motion.tracks.push_back(std::move(track));
      for (const DrawnPart& each : drawn)
        if (carries(each))
          add_node({.name = each.part->name,
                    .parent = node,
                    .surface = surface_of(each),
                    .extras = {{"kind", kind_of(each.part->role)}}});
    }
  }

  Pose pose_at(std::size_t frame, BodyId body) const {
    return completed(bodies_, frames_[frame].poses)[body];
  }

  /// Places of the drawn face, all vertices, in a frame.
  Points face_in(const FrameState& frame, const Part& part) const {
    Points places;
    if (frame.face.empty())
      places = floats(part.mesh.vertices);
    else if (const DrawnFace* face = prepared_.face_of(part))
      places = face->places(frame.face);
    else
      places = frame.face;
    if (const MouthLining* lining = prepared_.lining(); lining && lining->cut)
      even_rim(places, lining->rim);
    return places;
  }

  /// The face, and the lining of its mouth with the same keys.
  void add_face(const DrawnPart& drawn, GltfMotion& motion) {
    const MouthLining* lining = prepared_.lining();
    const BodyId lower_jaw = lower_jaw_of(prepared_.patient());
    std::vector<Points> faces, linings;
    for (const FrameState& frame : frames_) {
      const Points all = face_in(frame, *drawn.part);
      faces.push_back(drawn.kept.of(all));
      if (!lining) continue;
      Points rim;
      for (const int v : lining->rim) rim.push_back(all[static_cast<std::size_t>(v)]);
      linings.push_back(places_now(*lining, rim, completed(bodies_, frame.poses)[lower_jaw]));
    }
    const ShapeKeys keys = choose_shape_keys(faces, motion.times_s, settings_.key_error_mm);
    result_.keys = keys.frames.size();
    result_.key_error_mm = keys.frames.size() > 1 ? keys.error_mm + still_mm : keys.error_mm;
    if (keys.frames.size() > 1)
      for (const std::size_t f : keys.frames) motion.key_times_s.push_back(motion.times_s[f]);

    GltfSurface face = surface_of(drawn);
    face.two_sided = true;
    set_shapes(face, faces, keys);
    add_node({.name = drawn.part->name, .surface = std::move(face), .extras = {{"kind", "face"}}});
    if (!lining || lining->triangles.empty()) return;
    const Selection kept = used_by(coarser(lining->rest, lining->triangles,
                                           settings_.most_triangles / 8, settings_.simplified_mm),
                                   lining->rest.size());
    for (Points& places : linings) places = kept.of(places);
    GltfSurface inside{.vertices = {},
                       .normals = {},
                       .colors = kept.of(lining_colors(*lining)),
                       .triangles = kept.triangles,
                       .roughness = 0.4f,
                       .two_sided = true};
    set_shapes(inside, linings, keys);
    add_node(
        {.name = "mouth_lining", .surface = std::move(inside), .extras = {{"kind", "lining"}}});
  }

  static void set_shapes(GltfSurface& surface, const std::vector<Points>& shapes,
                         const ShapeKeys& keys) {
    surface.vertices = shapes.front();
    vertex_normals(surface.vertices, surface.triangles, surface.normals);
    for (std::size_t k = 1; k < keys.frames.size(); ++k) {
      Points target = shapes[keys.frames[k]];
      for (std::size_t v = 0; v < target.size(); ++v) {
        target[v] -= surface.vertices[v];
        if (target[v].norm() < still_mm) target[v].setZero();
      }
      surface.targets.push_back(std::move(target));
    }
  }

  const BodyTree& bodies_;
  const PreparedParts prepared_;
  const std::span<const FrameState> frames_;
  const MovingPatientSettings& settings_;
  MovingPatient result_;
};

}  // namespace

MovingPatient moving_patient(const BodyTree& bodies, std::span<const Part> parts,
                             std::span<const FrameState> frames,
                             const MovingPatientSettings& settings) {
  return PatientComposer(bodies, parts, frames, settings).compose();
}

}  // namespace condyle
