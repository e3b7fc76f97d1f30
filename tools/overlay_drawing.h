#pragma once

#include <map>
#include <string>
#include <vector>

#include "render/overlays.h"
#include "sim/frame/frame_state.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// What is drawn in space beside the patient.
struct OverlayChoice {
  bool springs = false;  // of the tissue: blue shortened, grey as at rest, red stretched
  bool prisms = false;   // their edges
  bool bone_springs =
      false;           // nodes attached to bone, vermilion the mandible's, blue the cranium's
  bool axes = false;   // through both condyles; the finite helical axis; L, P and S
  bool paths = false;  // of the condyles and the lower incisal point, as far as they came
};

/// Where condyles and lower incisal point have been.
class MotionPaths {
 public:
  /// Frames in the order of time; one not farther than 0.05 mm from the last adds nothing.
  void add(const Measures& measures);
  void clear() { incisor_.clear(), left_.clear(), right_.clear(); }
  LineSet lines() const;

 private:
  std::vector<Eigen::Vector3f> incisor_, left_, right_;
};

/// Lines of what is chosen, by name, as the frame has it; all names are always there, so that what
/// is not chosen is taken away. For SceneRenderer::set_lines.
std::map<std::string, LineSet> overlay_lines(const Scene& scene, const FrameState& frame,
                                             const OverlayChoice& choice, const MotionPaths& paths);

}  // namespace condyle
