#pragma once

#include <string>
#include <vector>

#include "sim/frame/frame_state.h"

namespace condyle {

/// The caption's lines with placeholders in braces replaced. throws: InputError for unknown
/// placeholders.
std::vector<std::string> caption_lines(const std::string& caption, int frame,
                                       const FrameState& state, const std::string& motion);

}  // namespace condyle
