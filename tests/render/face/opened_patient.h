#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "render/face/drawn_face.h"
#include "render/mesh/vertex_normals.h"
#include "sim/phantom/phantom.h"
#include "sim/simulator/simulator.h"

namespace condyle {

inline std::vector<Eigen::Vector3f> floats(const TriMesh& mesh) {
  std::vector<Eigen::Vector3f> places;
  for (const auto& p : mesh.vertices) places.push_back(p.cast<float>());
  return places;
}

/// A patient, with its drawn face, at rest and in motion.
struct OpenedPatient {
  SimulatorSettings settings;
  Scene scene;
  PreparedParts prepared{scene.patient.parts};
  const Part* face = nullptr;
  std::vector<const Part*> parts = {};
  std::vector<Eigen::Vector3f> rest = {}, normals = {};

  /// upper_face: the tissue includes the brows.
  explicit OpenedPatient(Case patient = builtin_patient({}, {}), bool upper_face = false)
      : settings(settings_with(upper_face)), scene(make_scene(std::move(patient), settings)) {
    for (const Part& part : scene.patient.parts) {
      parts.push_back(&prepared.drawn(part));
      if (part.role == Role::face) face = parts.back();
    }
    rest = floats(face->mesh);
    vertex_normals(rest, face->mesh.triangles, normals);
  }
  static SimulatorSettings settings_with(bool upper_face) {
    SimulatorSettings made;
    made.face = true;
    made.step_s = 1.0 / 60;
    made.tissue_model.upper_face = upper_face;
    return made;
  }
  FrameState frame(const std::string& words) {
    const Motion motion = make_motion(words + " over 1", scene.patient, scene.contacts);
    Playback playback(scene, motion, settings);
    return playback.at(motion.duration_s);
  }
  std::vector<Eigen::Vector3f> drawn(const FrameState& frame) const {
    const DrawnFace* smoother = prepared.face_of(*face);
    return smoother ? smoother->places(frame.face) : frame.face;
  }
  /// Of the vertices that differ from `before`: their number, for each jaw and row of teeth, and
  /// their least distance from these, mm; negative inside.
  std::pair<std::size_t, double> clearance(const FrameState& frame,
                                           const std::vector<Eigen::Vector3f>& before,
                                           const std::vector<Eigen::Vector3f>& places) const {
    std::size_t tested = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Part* part : parts) {
      if (!collides(part->role)) continue;
      const TriangleTree tree(part->mesh);
      const Pose X_BC = pose_of(*part, frame.poses).inverse();
      for (std::size_t v = 0; v < places.size(); ++v) {
        if (places[v] == before[v]) continue;
        ++tested;
        nearest = std::min(nearest, tree.signed_distance(X_BC * places[v].cast<double>()));
      }
    }
    return {tested, nearest};
  }
  /// Corner of the mouth at rest. side: 1 left, -1 right.
  Eigen::Vector3f corner(float side) const {
    Eigen::Vector3f best = rest[static_cast<std::size_t>(prepared.lining()->rim.front())];
    for (const int v : prepared.lining()->rim)
      if (const Eigen::Vector3f& p = rest[static_cast<std::size_t>(v)];
          side * p.x() > side * best.x())
        best = p;
    return best;
  }
};

inline OpenedPatient& opened_patient() {
  static OpenedPatient made;
  return made;
}

}  // namespace condyle
