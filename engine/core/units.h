#pragma once

#include <numbers>

namespace condyle {

inline constexpr double mm_per_m = 1000;                              // 1 N = 1000 kg mm/s^2
inline constexpr double degree = std::numbers::pi / 180;              // rad
inline constexpr double degrees_per_radian = 180 / std::numbers::pi;  // not exactly 1 / degree

}  // namespace condyle
