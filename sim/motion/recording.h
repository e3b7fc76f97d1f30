#pragma once

#include <filesystem>

#include "sim/motion/motion.h"

namespace condyle {

/// A recorded motion, from any file that sim/motion/recording_files.h knows; a sidecar
/// (sim/motion/recording_map.h) tells what the file does not. Each pose becomes X_CM: x_now =
/// R x_rest + t. Time is counted from the first row; between rows translation is linear and
/// rotation slerp. One row is a still pose. Gaps, residuals of markers and what looks wrong are
/// told in the motion's `notes` and `recording`. Nothing is corrected. throws: InputError with
/// file, line and value.
Motion read_recording(const std::filesystem::path& file);

/// Notes what a jaw does not do, by its landmarks: metres for millimetres, upward for down, a first
/// pose far from rest, speeds and turns out of reach.
void note_what_looks_wrong(const Case& patient, Motion& motion);

}  // namespace condyle
