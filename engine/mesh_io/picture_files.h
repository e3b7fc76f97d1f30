#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace condyle {

struct ColourPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // sRGB, rows from the top
};

/// One number for each pixel, such as a depth.
struct GreyPicture {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;  // rows from the top
};

/// A JPEG or PNG. throws: InputError when it is none, damaged or larger than 16384 a side.
ColourPicture read_colour_picture(const std::filesystem::path& file);

/// A PNG with 16 bits a pixel, whose numbers stay as they are. throws: InputError, as above, and
/// for 8 bits.
GreyPicture read_grey_picture(const std::filesystem::path& file);

/// PNG, 8 bits a colour and 16 bits a pixel. throws: MachineError.
void write_picture(const ColourPicture& picture, const std::filesystem::path& file);
void write_picture(const GreyPicture& picture, const std::filesystem::path& file);

}  // namespace condyle
