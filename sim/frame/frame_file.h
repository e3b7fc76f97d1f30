#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "sim/frame/frame_state.h"

namespace condyle {

/// A frame as bytes: "CONDYLEF", the version of the format, measured times, closure of the lids,
/// the fields in the order of visit_frame() and their hash, little-endian. Writing and reading
/// round-trips bit-identically.
std::string frame_bytes(const FrameState& frame);

/// throws: InputError, with `file` as the name, for bytes that are no frame, another version,
/// missing or excess bytes, and a hash that does not match.
FrameState frame_of_bytes(std::string_view bytes, const std::filesystem::path& file);

/// throws: MachineError when the file cannot be written.
void write_frame(const FrameState& frame, const std::filesystem::path& file);
/// throws: InputError as frame_of_bytes(), and for a file that cannot be read.
FrameState read_frame(const std::filesystem::path& file);

}  // namespace condyle
