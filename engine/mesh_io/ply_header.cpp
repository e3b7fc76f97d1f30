#include "engine/mesh_io/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh_io/line_reader.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/readers.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

std::optional<PlyType> type_named(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> types = {{
      {"char", PlyType::i8},
      {"int8", PlyType::i8},
      {"uchar", PlyType::u8},
      {"uint8", PlyType::u8},
      {"short", PlyType::i16},
      {"int16", PlyType::i16},
      {"ushort", PlyType::u16},
      {"uint16", PlyType::u16},
      {"int", PlyType::i32},
      {"int32", PlyType::i32},
      {"uint", PlyType::u32},
      {"uint32", PlyType::u32},
      {"float", PlyType::f32},
      {"float32", PlyType::f32},
      {"double", PlyType::f64},
      {"float64", PlyType::f64},
  }};
  for (const auto& [known, type] : types)
    if (known == name) return type;
  return std::nullopt;
}

PlyType need_type(const fs::path& file, const LineReader& lines, std::string_view name) {
  if (const auto type = type_named(name)) return *type;
  throw InputError(file, "header " + lines.where(),
                   "the type " + in_quotes(name) +
                       " is unknown; PLY has char, uchar, short, ushort, "
                       "int, uint, float and double");
}

void read_element(const fs::path& file, LineReader& lines, PlyHeader& header) {
  PlyElement element;
  element.name = lines.word();
  const std::string_view word = lines.word();
  const auto count = to_number<double>(word);
  if (element.name.empty() || !count || !(*count >= 0) ||
      *count != static_cast<double>(static_cast<long long>(std::min(*count, 1e18))))
    throw InputError(file, "header " + lines.where(),
                     "the number of an element is " + in_quotes(word) +
                         "; it must be a whole number, 0 or more");
  if (element.name == "vertex") check_count(file, "vertices", *count, max_mesh_vertices);
  if (element.name == "face") check_count(file, "faces", *count, max_mesh_triangles);
  element.count = static_cast<std::size_t>(std::min(*count, 1e15));
  for (const auto& other : header.elements)
    if (other.name == element.name)
      throw InputError(file, "header " + lines.where(),
                       "the element " + in_quotes(element.name) + " occurs twice");
  header.elements.push_back(std::move(element));
}

void read_property(const fs::path& file, LineReader& lines, PlyHeader& header) {
  if (header.elements.empty())
    throw InputError(file, "header " + lines.where(), "a property precedes the first element");
  PlyProperty property;
  std::string_view word = lines.word();
  if (word == "list") {
    property.list = true;
    property.count_type = need_type(file, lines, lines.word());
    if (property.count_type == PlyType::f32 || property.count_type == PlyType::f64)
      throw InputError(file, "header " + lines.where(),
                       "the count of a list must be a whole number type");
    word = lines.word();
  }
  property.type = need_type(file, lines, word);
  property.name = lines.word();
  if (property.name.empty())
    throw InputError(file, "header " + lines.where(), "the property has no name");
  header.elements.back().properties.push_back(std::move(property));
}

/// Minimum size of the body; a count that needs more is refused before memory is allocated.
void check_promise(const fs::path& file, const PlyHeader& header, std::size_t body) {
  double total = 0;
  for (const auto& element : header.elements) {
    double least = 0;
    for (const auto& property : element.properties) {
      if (header.format == PlyHeader::Format::ascii)
        least += 2;  // a digit and a separator
      else
        least += static_cast<double>(property.list ? size_of(property.count_type)
                                                   : size_of(property.type));
    }
    // Without properties there is nothing to read, and a count without bytes could not be checked.
    if (element.properties.empty() && element.count > 0)
      throw InputError(file, "header",
                       "the element " + in_quotes(element.name) + " has no properties");
    total += least * static_cast<double>(element.count);
    const double spare =
        header.format == PlyHeader::Format::ascii ? 1 : 0;  // the last needs no separator
    if (total > static_cast<double>(body) + spare)
      throw InputError(
          file, "header",
          fmt::format("promises {} {}, but only {} bytes follow: the file is cut short or damaged; "
                      "export or copy it again",
                      element.count,
                      element.name == "vertex" ? "vertices" : element.name + " elements", body));
  }
}

}  // namespace

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return static_cast<int>(i);
  return -1;
}

PlyHeader read_ply_header(const fs::path& file, std::string_view content) {
  LineReader lines(content);
  lines.next();
  if (lines.line() != "ply")
    throw InputError(file, "",
                     "is not a PLY file (it begins like " + looks_like(content) +
                         "); give it the right extension, or export it as PLY");
  PlyHeader header;
  bool formatted = false, ended = false;
  while (!ended && lines.next()) {
    const std::string_view key = lines.word();
    if (key == "format") {
      const std::string_view name = lines.word(), version = lines.word();
      formatted = true;
      if (name == "ascii")
        header.format = PlyHeader::Format::ascii;
      else if (name == "binary_little_endian")
        header.format = PlyHeader::Format::little;
      else if (name == "binary_big_endian")
        header.format = PlyHeader::Format::big;
      else
        formatted = false;
      if (!formatted || version != "1.0")
        throw InputError(
            file, "header " + lines.where(),
            "the format " + in_quotes(name) + " " + in_quotes(version) +
                " is unknown; ascii, binary_little_endian and binary_big_endian 1.0 are read");
    } else if (key == "element") {
      read_element(file, lines, header);
    } else if (key == "property") {
      read_property(file, lines, header);
    } else if (key == "end_header") {
      ended = true;
    } else if (!key.empty() && key != "comment" && key != "obj_info") {
      throw InputError(file, "header " + lines.where(),
                       "the word " + in_quotes(key) + " is not of a PLY header");
    }
    if (lines.number() > 10000) break;
  }
  if (!ended)
    throw InputError(file, "header", "has no \"end_header\": the file is cut short or damaged");
  if (!formatted) throw InputError(file, "header", "has no \"format\" line");
  header.size = content.size() - lines.rest().size();
  header.lines = lines.number();
  check_promise(file, header, lines.rest().size());
  return header;
}

}  // namespace condyle
