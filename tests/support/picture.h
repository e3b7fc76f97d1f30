#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace condyle::test {

/// A picture to look at: RGBA of 8 bits, rows from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  Picture() = default;
  /// Of a PNG file; empty when it cannot be read.
  explicit Picture(const std::string& file);
  bool empty() const { return rgba.empty(); }
  /// The pixel at shares of width and height.
  const std::uint8_t* at(double x, double y) const {
    const auto column = static_cast<std::size_t>(x * width),
               row = static_cast<std::size_t>(y * height);
    return &rgba[4 * (row * static_cast<std::size_t>(width) + column)];
  }
  void save(const std::filesystem::path& file) const;
};

/// A rectangle of a picture, pixels.
struct Region {
  double x = 0, y = 0, width = 1e9, height = 1e9;
};

/// The measure of how far two pictures differ: the share of the pixels of which any channel differs
/// by more than 12 of 255 (what antialiasing and rounding never do). 1 for pictures of two sizes.
double difference(const Picture& a, const Picture& b, const Region& region = {});

/// Where tests keep pictures for people: build/test-results/pictures.
std::filesystem::path kept_pictures();

}  // namespace condyle::test
