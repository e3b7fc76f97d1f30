#include "engine/dicom/dicom_elements.h"

#include <algorithm>
#include <array>

#include "engine/core/error.h"
#include "engine/volume/unpack.h"

// source: DICOM PS3.5, chapters 7 and 10 and annex A; PS3.10, chapter 7

namespace condyle {
namespace {

constexpr std::uint64_t preamble = 128;
constexpr std::uint32_t undefined = 0xffffffff;
constexpr std::uint32_t item = dicom_tag(0xfffe, 0xe000), end_of_item = dicom_tag(0xfffe, 0xe00d),
                        end_of_sequence = dicom_tag(0xfffe, 0xe0dd);
constexpr std::uint32_t pixel_data = dicom_tag(0x7fe0, 0x0010),
                        syntax_uid = dicom_tag(0x0002, 0x0010);
constexpr int deepest_sequence = 32;
constexpr std::size_t longest_value = 4096;  // of those that are kept
constexpr std::size_t most_inflated = std::size_t{1} << 28;

struct ElementHeader {
  std::uint32_t tag = 0, length = 0;
  bool unknown_type = false;  // UN
  std::uint64_t value = 0;    // where it begins
};

bool is_type(char a, char b) { return a >= 'A' && a <= 'Z' && b >= 'A' && b <= 'Z'; }

bool has_long_length(std::string_view type) {
  static constexpr std::array<std::string_view, 12> types = {"OB", "OD", "OF", "OL", "OV", "OW",
                                                             "SQ", "UC", "UN", "UR", "UT", "SV"};
  return std::find(types.begin(), types.end(), type) != types.end() || type == "UV";
}

ElementHeader element_at(DicomBytes& bytes, std::uint64_t at, const TransferSyntax& syntax) {
  const bool big = syntax.big_endian;
  std::string_view head = bytes.read(at, 8);
  ElementHeader element{dicom_number(head.substr(0, 2), big) << 16 |
                        dicom_number(head.substr(2, 2), big)};
  if (syntax.implicit_vr || element.tag >> 16 == 0xfffe) {
    element.length = dicom_number(head.substr(4, 4), big);
    element.value = at + 8;
    return element;
  }
  if (!is_type(head[4], head[5])) throw DicomDamage("has a damaged header");
  const std::string type(head.substr(4, 2));
  if (!has_long_length(type)) {
    element.length = dicom_number(head.substr(6, 2), big);
    element.value = at + 8;
    return element;
  }
  element.unknown_type = type == "UN";
  element.length = dicom_number(bytes.read(at + 8, 4), big);
  element.value = at + 12;
  return element;
}

std::uint64_t end_of_value(DicomBytes& bytes, const ElementHeader& element,
                           const TransferSyntax& syntax, int depth);

/// Where an item of undefined length ends.
std::uint64_t end_of_open_item(DicomBytes& bytes, std::uint64_t at, const TransferSyntax& syntax,
                               int depth) {
  for (;;) {
    const ElementHeader element = element_at(bytes, at, syntax);
    if (element.tag == end_of_item) return element.value;
    at = end_of_value(bytes, element, syntax, depth);
  }
}

/// Where the value of an element ends, also of a sequence of undefined length.
std::uint64_t end_of_value(DicomBytes& bytes, const ElementHeader& element,
                           const TransferSyntax& syntax, int depth) {
  if (element.length != undefined) {
    if (!bytes.has(element.value, element.length)) throw DicomDamage("ends early");
    return element.value + element.length;
  }
  if (depth > deepest_sequence) throw DicomDamage("has sequences nested too deeply");
  const TransferSyntax& inner = element.unknown_type ? implicit_little_endian : syntax;
  for (std::uint64_t at = element.value;;) {
    const ElementHeader next = element_at(bytes, at, inner);
    if (next.tag == end_of_sequence) return next.value;
    if (next.tag != item) throw DicomDamage("has a damaged sequence");
    at = next.length == undefined ? end_of_open_item(bytes, next.value, inner, depth + 1)
                                  : end_of_value(bytes, next, inner, depth);
  }
}

/// Files without preamble begin with their first element, of group 8.
bool begins_with_element(DicomBytes& bytes) {
  if (!bytes.has(0, 8)) return false;
  const std::string_view head = bytes.read(0, 8);
  const std::uint32_t group = dicom_number(head.substr(0, 2), false);
  if ((group != 2 && group != 8) || dicom_number(head.substr(2, 2), false) > 0x20) return false;
  if (is_type(head[4], head[5])) return true;
  return group == 8 && dicom_number(head.substr(4, 4), false) <= 64;
}

std::optional<std::uint64_t> first_element(DicomBytes& bytes) {
  if (bytes.has(preamble, 4) && bytes.read(preamble, 4) == "DICM") return preamble + 4;
  if (begins_with_element(bytes)) return 0;
  return std::nullopt;
}

/// Without the blank or zero that makes the length even.
std::string_view unpadded(std::string_view text) {
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
  return text;
}

/// Reads the elements of group 2. Returns where the data set begins; `uid`: of its syntax.
std::uint64_t read_meta(DicomBytes& bytes, std::uint64_t at, std::string& uid) {
  while (bytes.has(at, 2) && dicom_number(bytes.read(at, 2), false) == 2) {
    const ElementHeader element = element_at(bytes, at, explicit_little_endian);
    const std::uint64_t end = end_of_value(bytes, element, explicit_little_endian, 0);
    if (element.tag == syntax_uid && element.length <= 64)
      uid = unpadded(bytes.read(element.value, element.length));
    at = end;
  }
  return at;
}

/// The syntax by the form of the first element.
const TransferSyntax& likely_syntax(DicomBytes& bytes, std::uint64_t at) {
  if (!bytes.has(at, 8)) return implicit_little_endian;
  const std::string_view head = bytes.read(at, 8);
  return is_type(head[4], head[5]) ? explicit_little_endian : implicit_little_endian;
}

void read_values(DicomBytes& bytes, std::uint64_t at, const std::vector<std::uint32_t>& tags,
                 DicomElements& found) {
  while (at < bytes.size()) {
    const ElementHeader element = element_at(bytes, at, *found.syntax);
    if (element.tag == pixel_data) {
      found.pixels = {element.value, element.length, element.length == undefined};
      return;
    }
    at = end_of_value(bytes, element, *found.syntax, 0);
    if (std::find(tags.begin(), tags.end(), element.tag) == tags.end()) continue;
    if (element.length > longest_value) throw DicomDamage("has a damaged header");
    found.values[element.tag] = bytes.read(element.value, element.length);
  }
}

}  // namespace

std::uint32_t dicom_number(std::string_view bytes, bool big_endian) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    number = number << 8 | static_cast<unsigned char>(bytes[big_endian ? i : bytes.size() - 1 - i]);
  return number;
}

std::optional<DicomBytes> open_dicom(const std::filesystem::path& file) {
  DicomBytes bytes(file);
  const auto first = first_element(bytes);
  if (!first) return std::nullopt;
  std::string uid;
  std::uint64_t begin = 0;
  try {
    begin = read_meta(bytes, *first, uid);
  } catch (const DicomDamage&) {
    return bytes;  // read_elements() reports it
  }
  const TransferSyntax* syntax = transfer_syntax(uid);
  if (!syntax || !syntax->deflated) return bytes;
  if (bytes.size() > most_inflated) throw DicomDamage("is too large");
  std::string content(bytes.read(0, static_cast<std::size_t>(begin)));
  try {
    content += unpack_deflate(bytes.read(begin, static_cast<std::size_t>(bytes.size() - begin)),
                              most_inflated, {});
  } catch (const InputError&) {
    throw DicomDamage("has damaged compressed data");
  }
  return DicomBytes(std::move(content));
}

DicomElements read_elements(DicomBytes& bytes, const std::vector<std::uint32_t>& tags) {
  DicomElements found;
  try {
    const auto first = first_element(bytes);
    if (!first) throw DicomDamage("is not a DICOM file");
    std::string uid;
    const std::uint64_t begin = read_meta(bytes, *first, uid);
    found.syntax = transfer_syntax(uid);
    found.known_syntax = found.syntax || uid.empty();
    const TransferSyntax& likely = likely_syntax(bytes, begin);
    // Some files state the one of these two that they do not have.
    const bool either =
        found.syntax == &implicit_little_endian || found.syntax == &explicit_little_endian;
    if (!found.syntax || either) found.syntax = &likely;
    read_values(bytes, begin, tags, found);
  } catch (const DicomDamage& damage) {
    found.damage = damage.what();
  }
  return found;
}

std::vector<PixelLocation> pixel_fragments(DicomBytes& bytes, std::uint64_t begin) {
  std::vector<PixelLocation> fragments;
  bool table = true;  // the first item holds the offsets of frames
  for (std::uint64_t at = begin;;) {
    const ElementHeader element = element_at(bytes, at, explicit_little_endian);
    if (element.tag == end_of_sequence) return fragments;
    if (element.tag != item || element.length == undefined ||
        !bytes.has(element.value, element.length))
      throw DicomDamage("has compressed pixels that end early");
    if (!table) fragments.push_back({element.value, element.length, true});
    table = false;
    at = element.value + element.length;
  }
}

}  // namespace condyle
