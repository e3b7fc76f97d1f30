#pragma once

#include <string>
#include <vector>

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

/// The built-in patient, with its drawn face, at rest and in motion.
struct OpenedPatient {
  SimulatorSettings settings = [] {
    SimulatorSettings made;
    made.face = true;
    made.step_s = 1.0 / 60;
    return made;
  }();
  Scene scene = make_scene(builtin_patient({}, {}), settings);
  PreparedParts prepared{scene.patient.parts};
  const Part* face = nullptr;
  std::vector<const Part*> parts = {};
  std::vector<Eigen::Vector3f> rest = {}, normals = {};

  OpenedPatient() {
    for (const Part& part : scene.patient.parts) {
      parts.push_back(&prepared.drawn(part));
      if (part.role == Role::face) face = parts.back();
    }
    rest = floats(face->mesh);
    vertex_normals(rest, face->mesh.triangles, normals);
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
