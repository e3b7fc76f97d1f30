#pragma once

#include <span>
#include <string>

#include "engine/gltf/gltf_scene.h"
#include "sim/frame/body_tree.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

struct MovingPatientSettings {
  int most_triangles = 20000;     // of each surface
  double simplified_mm = 0.2;     // deviation of simplified surfaces, about
  double key_error_mm = 0.25;     // of the face between its keys
  std::string generator = {};     // program and version
  std::string motion = "motion";  // name of the animation
};

/// A patient as a scene for glb_bytes(), with what was measured of it.
struct MovingPatient {
  GltfScene scene;
  std::size_t keys = 0;     // shapes of the face; 0 without a face
  double key_error_mm = 0;  // largest distance of the face from a frame, of all frames
};

/// Bones, teeth and mouth as rigid surfaces on nodes of their bodies, the face as displayed (see
/// PreparedParts) with the lining of its mouth. Several frames are a motion: tracks of the bodies
/// at the time of each frame, and shapes of the face at as few of them as the error permits. One
/// frame is a pose. Colours include the shade of neighbours. Each node of a surface has its `kind`
/// among its extras: bone, teeth, mouth, eyes, face, lining.
MovingPatient moving_patient(const BodyTree& bodies, std::span<const Part> parts,
                             std::span<const FrameState> frames,
                             const MovingPatientSettings& settings = {});

}  // namespace condyle
