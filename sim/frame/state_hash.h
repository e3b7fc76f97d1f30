#pragma once

#include <cstdint>

#include "sim/frame/frame_state.h"

namespace condyle {

/// Hash of the bits of every field of a frame except its measured times, the closure of the lids
/// and the hash itself.
std::uint64_t state_hash(const FrameState& frame);

}  // namespace condyle
