#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"
#include "engine/mesh_io/line_reader.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/ply_header.h"
#include "engine/mesh_io/polygon.h"
#include "engine/mesh_io/readers.h"

static_assert(std::endian::native == std::endian::little);

namespace condyle {
namespace {

namespace fs = std::filesystem;

/// Values of a binary body, one after another.
class BinaryBody {
 public:
  BinaryBody(const fs::path& file, std::string_view bytes, bool big)
      : file_(file), rest_(bytes), big_(big) {}

  void begin(const PlyElement& element, std::size_t index) { element_ = &element, index_ = index; }

  double value(PlyType type) {
    const std::size_t size = size_of(type);
    if (rest_.size() < size)
      throw InputError(file_, fmt::format("{} {}", element_->name, index_),
                       fmt::format("the file ends here, {} were promised: it is cut short; export "
                                   "or copy it again",
                                   element_->count));
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), rest_.data(), size);
    rest_.remove_prefix(size);
    if (big_) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    switch (type) {
      case PlyType::i8:
        return as<std::int8_t>(bytes);
      case PlyType::u8:
        return as<std::uint8_t>(bytes);
      case PlyType::i16:
        return as<std::int16_t>(bytes);
      case PlyType::u16:
        return as<std::uint16_t>(bytes);
      case PlyType::i32:
        return as<std::int32_t>(bytes);
      case PlyType::u32:
        return as<std::uint32_t>(bytes);
      case PlyType::f32:
        return as<float>(bytes);
      case PlyType::f64:
        return as<double>(bytes);
    }
    return 0;
  }
  void end() {}
  std::string where() const { return ""; }
  std::size_t rest() const { return rest_.size(); }

 private:
  template <class T>
  static double as(const std::array<char, 8>& bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return static_cast<double>(value);
  }
  const fs::path& file_;
  std::string_view rest_;
  bool big_;
  const PlyElement* element_ = nullptr;
  std::size_t index_ = 0;
};

/// Values of a text body: one element per line.
class TextBody {
 public:
  TextBody(const fs::path& file, std::string_view text, long header_lines)
      : file_(file), lines_(text), header_lines_(header_lines) {}

  void begin(const PlyElement& element, std::size_t index) {
    element_ = &element, index_ = index;
    do {
      if (!lines_.next())
        throw InputError(file_, fmt::format("{} {}", element.name, index),
                         fmt::format("the file ends here, {} were promised: it is cut short; "
                                     "export or copy it again",
                                     element.count));
      word_ = lines_.word();
    } while (word_.empty());
  }
  double value(PlyType type) {
    if (word_.empty()) refuse("the line has too few numbers");
    const auto number = to_number<double>(word_);
    if (!number) refuse("has " + in_quotes(word_) + " where a number should be");
    word_ = lines_.word();
    // In single precision where the header says so: text and binary yield the same bits.
    return type == PlyType::f32 ? static_cast<double>(static_cast<float>(*number)) : *number;
  }
  void end() {
    if (!word_.empty()) refuse("has " + in_quotes(word_) + " after its last number");
  }
  std::string where() const { return fmt::format(" (line {})", header_lines_ + lines_.number()); }
  std::size_t rest() {
    while (lines_.next())
      if (!lines_.word().empty()) return lines_.line().size() + lines_.rest().size() + 1;
    return 0;
  }

 private:
  [[noreturn]] void refuse(const std::string& problem) const {
    throw InputError(file_, fmt::format("{} {}{}", element_->name, index_, where()), problem);
  }
  const fs::path& file_;
  LineReader lines_;
  long header_lines_;
  const PlyElement* element_ = nullptr;
  std::size_t index_ = 0;
  std::string_view word_;
};

/// The use of each vertex property.
struct VertexLayout {
  std::array<int, 3> place{-1, -1, -1}, color{-1, -1, -1};
  double color_scale = 1;
  bool colored() const { return color[0] >= 0 && color[1] >= 0 && color[2] >= 0; }
};

VertexLayout vertex_layout(const fs::path& file, const PlyElement& vertex) {
  VertexLayout layout;
  constexpr std::array<const char*, 3> axes = {"x", "y", "z"};
  constexpr std::array<const char*, 3> colors = {"red", "green", "blue"};
  constexpr std::array<const char*, 3> diffuse = {"diffuse_red", "diffuse_green", "diffuse_blue"};
  for (std::size_t k = 0; k < 3; ++k) {
    layout.place[k] = vertex.find(axes[k]);
    if (layout.place[k] < 0 || vertex.properties[static_cast<std::size_t>(layout.place[k])].list)
      throw InputError(file, "header", fmt::format("the vertices have no number \"{}\"", axes[k]));
    layout.color[k] = std::max(vertex.find(colors[k]), vertex.find(diffuse[k]));
  }
  if (layout.colored()) {
    const auto& red = vertex.properties[static_cast<std::size_t>(layout.color[0])];
    if (red.type == PlyType::u8 || red.type == PlyType::i8) layout.color_scale = 255;
    if (red.type == PlyType::u16 || red.type == PlyType::i16) layout.color_scale = 65535;
    if (red.type == PlyType::i32 || red.type == PlyType::u32) layout.color_scale = 255;
  }
  return layout;
}

template <class Body>
std::size_t list_count(const fs::path& file, Body& body, const PlyElement& element,
                       std::size_t index, const PlyProperty& property) {
  const double count = body.value(property.count_type);
  if (!(count >= 0) || count != std::floor(count) || count > 1e9)
    throw InputError(file, fmt::format("{} {}{}", element.name, index, body.where()),
                     fmt::format("its list \"{}\" has {} items", property.name, count));
  return static_cast<std::size_t>(count);
}

template <class Body>
void read_vertices(const fs::path& file, Body& body, const PlyElement& element, TriMesh& mesh) {
  const VertexLayout layout = vertex_layout(file, element);
  mesh.vertices.reserve(element.count);
  if (layout.colored()) mesh.colors.reserve(element.count);
  std::vector<double> values(element.properties.size());
  for (std::size_t i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (std::size_t p = 0; p < values.size(); ++p) {
      const auto& property = element.properties[p];
      if (property.list)
        for (std::size_t n = list_count(file, body, element, i, property); n > 0; --n)
          body.value(property.type);
      else
        values[p] = body.value(property.type);
    }
    body.end();
    const auto at = [&](int p) { return values[static_cast<std::size_t>(p)]; };
    const Eigen::Vector3d v(at(layout.place[0]), at(layout.place[1]), at(layout.place[2]));
    if (!sound_point(v)) refuse_point(file, fmt::format("vertex {}{}", i, body.where()), v);
    mesh.vertices.push_back(v);
    if (!layout.colored()) continue;
    Eigen::Vector3f color;
    for (std::size_t k = 0; k < 3; ++k) {
      const double c = at(layout.color[k]) / layout.color_scale;
      if (!(c >= 0 && c <= 1))
        throw InputError(file, fmt::format("vertex {}{}", i, body.where()),
                         fmt::format("its colour {} is outside 0 to {}", at(layout.color[k]),
                                     layout.color_scale));
      color[static_cast<int>(k)] = static_cast<float>(c);
    }
    mesh.colors.push_back(color);
  }
}

template <class Body>
void read_faces(const fs::path& file, Body& body, const PlyElement& element,
                std::size_t vertex_count, std::vector<int>& corners, std::vector<int>& ends) {
  int list = element.find("vertex_indices");
  if (list < 0) list = element.find("vertex_index");
  if (list < 0 || !element.properties[static_cast<std::size_t>(list)].list)
    throw InputError(file, "header", "the faces have no list \"vertex_indices\"");
  corners.reserve(3 * element.count);
  ends.reserve(element.count);
  const auto item = [&](std::size_t i) { return fmt::format("face {}{}", i, body.where()); };
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const auto& property = element.properties[p];
      const std::size_t n = property.list ? list_count(file, body, element, i, property) : 1;
      if (static_cast<int>(p) != list) {
        for (std::size_t k = 0; k < n; ++k) body.value(property.type);
        continue;
      }
      if (n < 3 || n > max_polygon_corners)
        throw InputError(
            file, item(i),
            fmt::format("has {} corners; 3 to {} are possible", n, max_polygon_corners));
      triangles += n - 2;
      check_count(file, "triangles", static_cast<double>(triangles), max_mesh_triangles);
      for (std::size_t k = 0; k < n; ++k) {
        const double index = body.value(property.type);
        if (!(index >= 0 && index < static_cast<double>(vertex_count)) ||
            index != std::floor(index))
          throw InputError(file, item(i),
                           fmt::format("speaks of vertex {}, but there are {} (0 to {})", index,
                                       vertex_count, static_cast<double>(vertex_count) - 1));
        corners.push_back(static_cast<int>(index));
      }
    }
    body.end();
    ends.push_back(static_cast<int>(corners.size()));
  }
}

template <class Body>
void skip_element(const fs::path& file, Body& body, const PlyElement& element) {
  for (std::size_t i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (const auto& property : element.properties) {
      const std::size_t n = property.list ? list_count(file, body, element, i, property) : 1;
      for (std::size_t k = 0; k < n; ++k) body.value(property.type);
    }
    body.end();
  }
}

template <class Body>
TriMesh read_body(const fs::path& file, Body& body, const PlyHeader& header) {
  TriMesh mesh;
  std::vector<int> corners, ends;
  std::size_t vertex_count = 0;
  for (const auto& element : header.elements)
    if (element.name == "vertex") vertex_count = element.count;
  for (const auto& element : header.elements) {
    if (element.name == "vertex")
      read_vertices(file, body, element, mesh);
    else if (element.name == "face")
      read_faces(file, body, element, vertex_count, corners, ends);
    else if (element.name == "tristrips" && element.count > 0)
      throw InputError(file, "header", "stores triangle strips; export it with plain faces");
    else
      skip_element(file, body, element);
  }
  if (const std::size_t rest = body.rest(); rest > 0)
    throw InputError(file, "",
                     fmt::format("{} bytes follow after the last element: the header "
                                 "does not fit the data; export it again",
                                 rest));
  // Polygons may precede the vertices: they are triangulated when both have been read.
  mesh.triangles.reserve(ends.size());
  std::size_t first = 0;
  for (const int end : ends) {
    const auto last = static_cast<std::size_t>(end);
    triangulate(std::span(corners).subspan(first, last - first), mesh.vertices, mesh.triangles);
    first = last;
  }
  return mesh;
}

}  // namespace

TriMesh read_ply(const fs::path& file, std::string_view content) {
  const PlyHeader header = read_ply_header(file, content);
  const std::string_view bytes = content.substr(header.size);
  if (header.format == PlyHeader::Format::ascii) {
    TextBody body(file, bytes, header.lines);
    return read_body(file, body, header);
  }
  BinaryBody body(file, bytes, header.format == PlyHeader::Format::big);
  return read_body(file, body, header);
}

}  // namespace condyle
