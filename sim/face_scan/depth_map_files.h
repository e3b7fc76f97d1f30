#pragma once

#include <filesystem>

#include "sim/face_scan/depth_map.h"

namespace condyle {

/// Reads a depth map by its description, a JSON object:
///   kind            "cylinder" or "plane"
///   depth, colour   names of PNG (16 bits; depth) and PNG or JPEG files beside it; colour may be
///                   absent, and larger than the depth map by one factor on both sides
///   unit_mm         of the numbers in the depth map; offset_mm is added (default 0)
///   invalid         the number of pixels without a depth (default 0)
///   angle_from_deg, angle_to_deg, height_mm   of a cylinder (default -180, 180; no default)
///   pixel_mm        of a plane
/// throws: InputError naming file, item and value.
FaceDepthMap read_depth_map(const std::filesystem::path& description);

/// Writes the description and the pictures beside it, NAME-depth.png and NAME-colour.png, depths in
/// hundredths of a millimetre. throws: MachineError; InputError for depths that do not fit.
void write_depth_map(const FaceDepthMap& map, const std::filesystem::path& description);

}  // namespace condyle
