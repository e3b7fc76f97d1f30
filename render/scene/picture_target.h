#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/gl/framebuffer.h"
#include "render/image/drawn_box.h"
#include "render/scene/background.h"

namespace condyle {

/// Pixels of background to be drawn around everything else, for the smoothing filter.
inline constexpr int drawn_air = 8;

/// Target of a picture: drawn into, smoothed and read back. Reuses memory between pictures of one
/// size, and processes only the drawn box: the rest is known.
class PictureTarget {
 public:
  /// smooth: FXAA, without multisampling.
  /// throws: MachineError when the driver cannot allocate a picture of this size.
  void fit(int width, int height, int samples, bool smooth);

  /// The framebuffer to draw into.
  const Framebuffer& drawn() const { return *drawn_; }

  /// The finished picture, RGBA. drawn: the drawn box, `drawn_air` larger than all but the
  /// background; around it is the backdrop. Opaque unless there is no backdrop.
  void read(const DrawnBox& drawn, std::optional<Backdrop> backdrop, bool from_the_top,
            std::vector<std::uint8_t>& rgba);

 private:
  int samples_asked_ = 0;
  std::optional<Framebuffer> drawn_, finished_;
  bool smooth_ = false;
  std::optional<Background> background_;
  std::vector<std::uint8_t> read_, smoothed_;  // reused between pictures
};

}  // namespace condyle
