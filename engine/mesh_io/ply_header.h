#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace condyle {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<int>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;  // of the value, or of a list's items
  bool list = false;
  PlyType count_type = PlyType::u8;  // of a list's count
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  /// Index of a property, -1 when it is absent.
  int find(std::string_view property) const;
};

struct PlyHeader {
  enum class Format { ascii, little, big } format = Format::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  // bytes up to the body
  long lines = 0;
};

/// Parses the header and checks each stated count against the size of the body.
/// throws: InputError naming the header's line.
PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view content);

}  // namespace condyle
