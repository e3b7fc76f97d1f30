#pragma once

#include <Eigen/Core>

#include "render/image/backdrop.h"

namespace condyle {

/// Colours of a text panel over a picture, sRGB.
struct TextPanelColours {
  Eigen::Vector3f ground, words, faint;  // faint: secondary text
  float cover;                           // opacity over the picture
};
inline TextPanelColours text_panel_colours(Backdrop backdrop) {
  const auto grey = [](float v) { return Eigen::Vector3f::Constant(v); };
  if (backdrop == Backdrop::light) return {{0.955f, 0.96f, 0.97f}, grey(0.10f), grey(0.33f), 0.9f};
  return {{0.09f, 0.10f, 0.12f}, grey(0.95f), grey(0.80f), 0.82f};
}

/// For bright lines on a light background.
inline const Eigen::Vector3f line_border = {0.10f, 0.11f, 0.13f};

}  // namespace condyle
