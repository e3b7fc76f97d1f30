#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/background.h"
#include "render/drawn_box.h"
#include "render/framebuffer.h"

namespace condyle {

/// Pixels of background to be drawn around everything else, for smoothing to look at.
inline constexpr int drawn_air = 8;

/// Where a picture is drawn, made smooth and read back. Keeps what pictures of one size share, and
/// works only where something is drawn: the rest is known.
class PictureTarget {
 public:
  /// smooth: FXAA, without multisampling.
  /// throws: MachineError when the driver cannot make a picture of this size.
  void fit(int width, int height, int samples, bool smooth);

  /// To be drawn into.
  const Framebuffer& drawn() const { return *drawn_; }

  /// The finished picture, RGBA. drawn: what was drawn into, `drawn_air` wider than all but the
  /// background; around it is the backdrop. Opaque, unless there is none.
  void read(const DrawnBox& drawn, std::optional<Backdrop> backdrop, bool from_the_top,
            std::vector<std::uint8_t>& rgba);

 private:
  int samples_asked_ = 0;
  std::optional<Framebuffer> drawn_, finished_;
  bool smooth_ = false;
  std::optional<Background> background_;
  std::vector<std::uint8_t> read_, smoothed_;  // kept for their memory
};

}  // namespace condyle
