#pragma once

#include <map>
#include <span>
#include <string>

#include "render/camera/camera.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// View of one arch from the occlusal plane, as on a dental chart: the patient's right on the left,
/// the upper front teeth at the top, the lower ones at the bottom. The other jaw and the soft
/// tissue are hidden.
class ArchView {
 public:
  static constexpr const char* upper = "upper-arch";
  static constexpr const char* lower = "lower-arch";
  static bool names(const std::string& camera) { return camera == upper || camera == lower; }

  /// `camera`: one of the two. The teeth, or without teeth the jaw, fill the picture.
  ArchView(const std::string& camera, std::span<const Part> parts, const BodyTree& bodies,
           const JawBodies& jaw, double aspect);

  /// The camera follows the arch.
  Camera at(const FrameState& frame) const;
  const Camera& at_rest() const { return camera_; }

  /// Opacity 0 for hidden parts, by part name.
  const std::map<std::string, double>& hidden() const { return hidden_; }

 private:
  BodyId body_;
  Camera camera_;
  std::map<std::string, double> hidden_;
};

}  // namespace condyle
