#pragma once

#include <filesystem>

#include "sim/motion/motion.h"

namespace condyle {

/// Reads a recorded motion in any format of sim/motion/recording_files.h; a sidecar file
/// (sim/motion/recording_map.h) supplies metadata. Each pose becomes X_CM: x_now = R x_rest + t.
/// Time is counted from the first row; translation is interpolated linearly, rotation by slerp. A
/// single row is a static pose. Gaps, marker residuals and implausible values are reported in the
/// motion's `notes` and `recording`; nothing is corrected. throws: InputError with file, line and
/// value.
Motion read_recording(const std::filesystem::path& file);

/// Adds notes on values that are implausible for a jaw, by its landmarks: wrong length unit,
/// inverted axes, a first pose far from rest, excessive speeds and rotations.
void note_implausible_values(const Case& patient, Motion& motion);

}  // namespace condyle
