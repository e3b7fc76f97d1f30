#pragma once

#include <cstdint>

#include "sim/frame/frame_state.h"

namespace condyle {

/// Hash of the bits of a frame's poses, contacts, tissue and measures. Times, stage times and the
/// displayed face (which follows from the tissue) are left out.
std::uint64_t state_hash(const FrameState& frame);

}  // namespace condyle
