#pragma once

#include <map>
#include <string>
#include <vector>

#include "render/overlay/overlay_key.h"
#include "render/overlay/overlays.h"
#include "sim/frame/frame_state.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Overlays drawn in space.
struct OverlayChoice {
  bool springs = false;  // of the tissue: blue shortened, grey at rest length, red stretched
  bool prisms = false;   // their edges
  bool bone_springs =
      false;             // nodes attached to bone, vermilion to the mandible, blue to the cranium
  bool axes = false;     // through both condyles; the finite helical axis; L, P and S
  bool paths = false;    // of the condyles and the lower incisal point, up to now
  bool muscles = false;  // of the jaw
  bool muscle_labels = false;   // their names
  bool facial_muscles = false;  // of the soft tissue
  bool layers = false;          // of the soft tissue, as translucent sheets
};

/// Entries for the colours of `overlay_lines` and of paths.
std::vector<KeyEntry> overlay_key(const OverlayChoice& choice, bool has_tissue);

/// Paths of the condyles and the lower incisal point.
class MotionPaths {
 public:
  /// Frames in increasing time; points less than 0.05 mm from the last are dropped.
  void add(const Measures& measures);
  void clear() { incisor_.clear(), left_.clear(), right_.clear(); }
  LineSet lines() const;

 private:
  std::vector<Eigen::Vector3f> incisor_, left_, right_;
};

/// Lines of the selected springs, prisms and axes at the frame, by name.
std::map<std::string, LineSet> overlay_lines(const Scene& scene, const FrameState& frame,
                                             const OverlayChoice& choice);

}  // namespace condyle
