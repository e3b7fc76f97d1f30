#pragma once

#include <filesystem>

#include "sim/motion/motion.h"

namespace condyle {

/// A recorded motion: CSV with the columns time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz in any order
/// (others are passed over), each row X_CM: x_now = R x_rest + t. Time is counted from the first
/// row; between rows translation is linear and rotation slerp. One row is a still pose.
/// throws: InputError with file, line and value.
Motion read_recording(const std::filesystem::path& file);

}  // namespace condyle
