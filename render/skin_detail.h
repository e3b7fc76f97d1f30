#pragma once

#include <cstdint>
#include <vector>

namespace condyle {

/// Roughness of skin as a field through space that repeats at the borders of a cube: the slope of
/// its height in red, green and blue, the height in alpha, 128 for none. Pores are pits between
/// cells of uneven size. side^3 x RGBA, 8 bit.
struct SkinDetail {
  static constexpr int side = 64;
  std::vector<std::uint8_t> rgba;
};

/// The same bits each time.
SkinDetail make_skin_detail();

}  // namespace condyle
