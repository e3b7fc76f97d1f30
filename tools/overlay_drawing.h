#pragma once

#include <map>
#include <string>
#include <vector>

#include "render/overlay_key.h"
#include "render/overlays.h"
#include "sim/frame/frame_state.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// What is drawn in space beside the patient.
struct OverlayChoice {
  bool springs = false;  // of the tissue: blue shortened, grey as at rest, red stretched
  bool prisms = false;   // their edges
  bool bone_springs =
      false;             // nodes attached to bone, vermilion the mandible's, blue the cranium's
  bool axes = false;     // through both condyles; the finite helical axis; L, P and S
  bool paths = false;    // of the condyles and the lower incisal point, as far as they came
  bool muscles = false;  // their lines of action
  bool layers = false;   // of the soft tissue, as see-through sheets
};

/// What the colours of `overlay_lines` and of paths mean.
std::vector<KeyEntry> overlay_key(const OverlayChoice& choice, bool has_tissue);

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

/// Lines of the springs, prisms and axes that are chosen, by name, as the frame has them.
std::map<std::string, LineSet> overlay_lines(const Scene& scene, const FrameState& frame,
                                             const OverlayChoice& choice);

}  // namespace condyle
