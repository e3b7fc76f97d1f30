#pragma once

namespace condyle {

/// Resolution and tolerance of distance fields on which bodies slide.
struct SlidingResolution {
  static constexpr double tooth_spacing_mm = 0.25, roaming_spacing_mm = 0.3, jaw_spacing_mm = 0.4,
                          cranium_spacing_mm = 0.5;
  static constexpr double tooth_sample_mm = 0.4, bone_sample_mm = 0.6;
  static constexpr double slop_mm = 0.01;  // half of what the exact surfaces allow: then they
                                           // seldom disagree
  static constexpr double fade_mm = 2;     // distance from rest over which the overlap there fades
};

}  // namespace condyle
