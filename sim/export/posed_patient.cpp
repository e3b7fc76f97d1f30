#include "sim/export/posed_patient.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/operation/owners.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Kind = SlicerMarkup::Kind;

void add_line(std::vector<SlicerMarkup>& markups, const std::string& name,
              const SlicerMarkup::Point& from, const SlicerMarkup::Point& to) {
  markups.push_back({Kind::line, name, {from, to}});
}

/// The angle at nasion between sella and a point, seen from the side, as in cephalometry.
void add_profile_angle(std::vector<SlicerMarkup>& markups, const std::string& name,
                       const Landmarks& landmarks, const std::string& point,
                       const ClinicalFrame& frame) {
  SlicerMarkup markup{Kind::angle, name, {}};
  for (const std::string& each : {std::string("sella"), std::string("nasion"), point}) {
    const auto found = landmarks.find(each);
    if (!found) return;
    markup.points.push_back({each, *found - frame.left * frame.left.dot(*found - frame.origin)});
  }
  markups.push_back(std::move(markup));
}

}  // namespace

std::vector<PosedSurface> posed_surfaces(const Scene& scene, const FrameState& frame) {
  const BodyPoses poses = completed(scene.patient.bodies, frame.poses);
  std::vector<PosedSurface> surfaces;
  bool face_is_done = false;
  for (const Part& part : scene.patient.parts) {
    PosedSurface posed{part.name, part.mesh};
    if (is_rigid(part.role)) {
      const Pose& X = pose_of(part, poses);
      if (!bit_identical(X, {}))
        for (Vector3d& v : posed.mesh.vertices) v = X * v;
    } else if (!face_is_done && frame.face.size() == posed.mesh.vertices.size()) {
      for (std::size_t v = 0; v < frame.face.size(); ++v)
        posed.mesh.vertices[v] = frame.face[v].cast<double>();
      face_is_done = true;
    }
    surfaces.push_back(std::move(posed));
  }
  return surfaces;
}

Landmarks posed_landmarks(const Scene& scene, const FrameState& frame) {
  constexpr double near_mm = 6;
  const Case& patient = scene.patient;
  const LandmarkOwners owners = landmark_owners(patient, OwnerFinder(patient, patient));
  Landmarks posed =
      moved_landmarks(patient.landmarks, owners, completed(patient.bodies, frame.poses));
  const Part* face = patient.find(Role::face);
  if (!face || frame.face.size() != face->mesh.vertices.size()) return posed;
  const TriangleTree tree(face->mesh);
  for (auto& [name, point] : posed.points) {
    if (owners.contains(name)) continue;
    const SurfacePoint near = tree.nearest(point, near_mm);
    if (near.triangle < 0) continue;
    const auto& corners = face->mesh.triangles[static_cast<std::size_t>(near.triangle)];
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(corners[k]);
      point += near.barycentric[k] * (frame.face[v].cast<double>() - face->mesh.vertices[v]);
    }
  }
  return posed;
}

std::vector<MovedBody> moved_bodies(const Scene& scene, const FrameState& frame,
                                    const Operated* operated) {
  const BodyTree& bodies = scene.patient.bodies;
  const BodyPoses now = completed(bodies, frame.poses);
  std::vector<MovedBody> moved;
  for (int b = 1; b < bodies.size(); ++b) {
    const BodyId body{b};
    const std::string& name = bodies[body].name;
    Pose X = now[body];
    if (operated)
      if (const auto cut = operated->patient.bodies.find(name))
        X = composed(X, completed(operated->patient.bodies, operated->poses)[*cut]);
    if (!bit_identical(X, {})) moved.push_back({name, X});
  }
  return moved;
}

std::vector<SlicerMarkup> measure_markups(const Scene& scene, const FrameState& frame,
                                          const Operated* operated) {
  std::vector<SlicerMarkup> markups;
  const Landmarks& rest = scene.patient.landmarks;
  const Landmarks now = posed_landmarks(scene, frame);
  const auto upper = now.find("upper_incisal_point"), lower = now.find("lower_incisal_point"),
             lower_at_rest = rest.find("lower_incisal_point");
  if (upper && lower)
    add_line(markups, "between incisors", {"upper_incisal_point", *upper},
             {"lower_incisal_point", *lower});
  if (lower && lower_at_rest && *lower != *lower_at_rest)
    add_line(markups, "path of the lower incisal point", {"at rest", *lower_at_rest},
             {"now", *lower});
  try {
    const ClinicalFrame clinical = clinical_frame(operated ? operated->patient.landmarks : rest);
    add_profile_angle(markups, "SNA", now, "a_point", clinical);
    add_profile_angle(markups, "SNB", now, "b_point", clinical);
    if (operated) {
      const Landmarks& before = operated->patient.landmarks;
      const Landmarks planned = planned_landmarks(*operated);
      for (const MovementRow& row : planned_movements(*operated, clinical).rows)
        if (row.distance_mm() > 0.05)
          add_line(markups, row.label + " planned", {"before", *before.find(row.landmark)},
                   {"after", *planned.find(row.landmark)});
    }
  } catch (const InputError&) {
    // Without the landmarks of the head there is no midsagittal plane.
  }
  return markups;
}

}  // namespace condyle
