#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace condyle {

/// 8-bit sRGB picture with straight alpha, rows from the top, 4 bytes per pixel.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// A picture of 1/n the width and height, each pixel the mean of n x n; weighted by alpha where
/// colours are premultiplied.
Image averaged(const Image& image, int n);

/// PNG bytes (level 1, SUB filter: fast and reproducible).
std::string encode_png(const Image& image);
/// throws: MachineError when it cannot be written; the old file is then unchanged.
void write_png(const std::filesystem::path& file, const Image& image);
/// throws: InputError when the file is missing, damaged or larger than 16384 pixels per side.
Image read_png(const std::filesystem::path& file);

}  // namespace condyle
