#pragma once

#include <cstdint>
#include <vector>

namespace condyle {

/// Roughness of skin as a periodic volume texture: the gradient of its height in red, green and
/// blue, the height in alpha, 128 for none. Pores are pits between cells of uneven size. side^3 x
/// RGBA, 8 bit.
struct SkinDetail {
  static constexpr int side = 64;
  std::vector<std::uint8_t> rgba;
};

/// Deterministic; made at the first call.
const SkinDetail& skin_detail();

}  // namespace condyle
