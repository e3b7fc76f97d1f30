#pragma once

namespace condyle {

inline constexpr double mm_per_m = 1000;  // 1 N = 1000 kg mm/s^2

}  // namespace condyle
