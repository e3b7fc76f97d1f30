#pragma once

#include <map>
#include <span>
#include <string>

#include "render/camera.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// One arch seen from the bite plane, as on a dentist's chart: the patient's right on the left, the
/// upper front teeth at the top, the lower ones at the bottom. What belongs to the other jaw, and
/// the soft tissue, is hidden.
class ArchView {
 public:
  static constexpr const char* upper = "upper-arch";
  static constexpr const char* lower = "lower-arch";
  static bool names(const std::string& camera) { return camera == upper || camera == lower; }

  /// `camera`: one of the two. The teeth fill the picture; without teeth, the jaw does.
  ArchView(const std::string& camera, std::span<const Part> parts, double aspect);

  /// The camera goes along with the arch.
  Camera at(const FrameState& frame) const;
  const Camera& at_rest() const { return camera_; }

  /// Opacity 0 of what is hidden, by part name.
  const std::map<std::string, double>& hidden() const { return hidden_; }

 private:
  Body body_;
  Camera camera_;
  std::map<std::string, double> hidden_;
};

}  // namespace condyle
