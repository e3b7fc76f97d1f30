#pragma once

#include <Eigen/Core>

#include "render/backdrop.h"

namespace condyle {

/// Colours of a pane of words that is laid over a picture, sRGB.
struct PaneInks {
  Eigen::Vector3f ground, words, faint;  // faint: what stands beside the words
  float cover;                           // of what is below
};
inline PaneInks pane_inks(Backdrop backdrop) {
  const auto grey = [](float v) { return Eigen::Vector3f::Constant(v); };
  if (backdrop == Backdrop::light) return {{0.955f, 0.96f, 0.97f}, grey(0.10f), grey(0.33f), 0.9f};
  return {{0.09f, 0.10f, 0.12f}, grey(0.95f), grey(0.80f), 0.82f};
}

/// Of bright lines on light ground.
inline const Eigen::Vector3f line_border = {0.10f, 0.11f, 0.13f};

}  // namespace condyle
