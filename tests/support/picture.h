#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace condyle::test {

/// A picture to examine: 8-bit RGBA, rows from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  Picture() = default;
  /// The picture of a PNG file; empty when it cannot be read.
  explicit Picture(const std::string& file);
  /// From any type with such pixels.
  template <class Image>
  requires requires(const Image& image) { image.rgba; }
  explicit Picture(const Image& image)
      : width(image.width), height(image.height), rgba(image.rgba) {}
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

/// Difference of two pictures: the fraction of the pixels of which any channel differs
/// by more than 12 of 255 (what antialiasing and rounding never do). 1 for pictures of two sizes.
double difference(const Picture& a, const Picture& b, const Region& region = {});

/// Share of the pixels whose colour is no farther than that 12 from 0xRRGGBB.
double colour_fraction(const Picture& picture, unsigned rgb, const Region& region = {});

// Expectations by that measure: EXPECT_TRUE(alike(seen, expected, 0.003)). One that is not met
// keeps both pictures in kept_pictures()/failed and names them.

/// At most this fraction of the pixels differs.
testing::AssertionResult alike(const Picture& seen, const Picture& expected, double most,
                               const Region& region = {});
/// More than this fraction of the pixels differs.
testing::AssertionResult unlike(const Picture& seen, const Picture& before, double least,
                                const Region& region = {});
/// The same to the byte.
testing::AssertionResult same_bytes(const Picture& seen, const Picture& expected);

template <class Image>
testing::AssertionResult alike(const Image& seen, const Image& expected, double most) {
  return alike(Picture(seen), Picture(expected), most);
}
template <class Image>
testing::AssertionResult unlike(const Image& seen, const Image& before, double least) {
  return unlike(Picture(seen), Picture(before), least);
}
template <class Image>
testing::AssertionResult same_bytes(const Image& seen, const Image& expected) {
  return same_bytes(Picture(seen), Picture(expected));
}

/// Where tests keep pictures for people: build/test-results/pictures.
std::filesystem::path kept_pictures();

}  // namespace condyle::test
