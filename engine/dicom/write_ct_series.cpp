#include "engine/dicom/write_ct_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "engine/core/atomic_output.h"
#include "engine/core/hash.h"

// source: DICOM PS3.3, table A.3-1 (CT image); PS3.5, section 7.1.2 and annex B.2 (identifiers)

namespace condyle {
namespace {

constexpr int intercept = -1024;
constexpr const char* ct_image_storage = "1.2.840.10008.5.1.4.1.1.2";

void append_number(std::string& bytes, std::uint32_t number, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(number >> (8 * i));
}

/// Elements in explicit little endian; they are added in ascending order.
class ElementWriter {
 public:
  void text(std::uint32_t group, std::uint32_t element, const char* type, std::string value) {
    if (value.size() % 2 != 0) value += std::string_view(type) == "UI" ? '\0' : ' ';
    head(group, element, type);
    append_number(bytes_, static_cast<std::uint32_t>(value.size()), 2);
    bytes_ += value;
  }
  void number(std::uint32_t group, std::uint32_t element, int value) {
    head(group, element, "US");
    append_number(bytes_, 2, 2);
    append_number(bytes_, static_cast<std::uint32_t>(value), 2);
  }
  /// Of OB and OW.
  void block(std::uint32_t group, std::uint32_t element, const char* type,
             const std::string& value) {
    head(group, element, type);
    append_number(bytes_, 0, 2);
    append_number(bytes_, static_cast<std::uint32_t>(value.size()), 4);
    bytes_ += value;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void head(std::uint32_t group, std::uint32_t element, const char* type) {
    append_number(bytes_, group, 2);
    append_number(bytes_, element, 2);
    bytes_ += type;
  }
  std::string bytes_;
};

/// A number in at most 16 characters.
std::string decimal_text(double value) {
  value += 0.0;  // no negative zero
  for (int digits = 15; digits > 0; --digits)
    if (std::string text = fmt::format("{:.{}g}", value, digits); text.size() <= 16) return text;
  return "0";
}

std::string decimal_texts(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : "\\") + decimal_text(value);
  return text;
}

/// An identifier below 2.25 of what is hashed and a role.
std::string identifier(std::uint64_t hash, std::uint32_t role) {
  hash = hash_bytes(&role, sizeof role, hash);
  return fmt::format("2.25.{}", hash);
}

struct SeriesIdentifiers {
  std::string study, series, frame;
  std::uint64_t content = 0;
};

SeriesIdentifiers identifiers_of(const Volume& volume, const CtWriteOptions& options) {
  std::uint64_t study = hash_bytes(&options.study, sizeof options.study);
  SeriesIdentifiers ids{identifier(study, 1), "", identifier(study, 2)};
  std::uint64_t content = hash_values(std::span(volume.values), study);
  content = hash_bytes(volume.size.data(), sizeof volume.size, content);
  content = hash_bytes(volume.spacing_mm.data(), 3 * sizeof(double), content);
  content = hash_bytes(volume.axes.data(), 9 * sizeof(double), content);
  content = hash_bytes(volume.origin.data(), 3 * sizeof(double), content);
  content = hash_bytes(options.kernel.data(), options.kernel.size(), content);
  content = hash_bytes(&options.series_number, sizeof options.series_number, content);
  ids.series = identifier(content, 3);
  ids.content = content;
  return ids;
}

/// The elements before the data set.
std::string file_meta(const std::string& instance) {
  ElementWriter meta;
  meta.block(0x0002, 0x0001, "OB", std::string("\0\1", 2));
  meta.text(0x0002, 0x0002, "UI", ct_image_storage);
  meta.text(0x0002, 0x0003, "UI", instance);
  meta.text(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1");
  meta.text(0x0002, 0x0012, "UI", "2.25.1129270372");
  std::string bytes(128, '\0');
  bytes += std::string("DICM\2\0\0\0UL\4\0", 12);
  append_number(bytes, static_cast<std::uint32_t>(meta.bytes().size()), 4);
  return bytes + meta.bytes();
}

std::string stored_values(const Volume& volume, int k) {
  const std::size_t count =
      static_cast<std::size_t>(volume.size[0]) * static_cast<std::size_t>(volume.size[1]);
  const std::int16_t* values = volume.values.data() + static_cast<std::size_t>(k) * count;
  std::string bytes;
  bytes.reserve(2 * count);
  for (std::size_t i = 0; i < count; ++i)
    append_number(bytes, static_cast<std::uint32_t>(std::max(values[i] - intercept, 0)), 2);
  return bytes;
}

void write_plane(const Volume& volume, int k, const SeriesIdentifiers& ids,
                 const CtWriteOptions& options, ElementWriter& out) {
  const Eigen::Vector3d at = volume.position(0, 0, k);
  const double directions[6] = {volume.axes(0, 0), volume.axes(1, 0), volume.axes(2, 0),
                                volume.axes(0, 1), volume.axes(1, 1), volume.axes(2, 1)};
  const double spacing[2] = {volume.spacing_mm.y(), volume.spacing_mm.x()};
  out.text(0x0020, 0x000d, "UI", ids.study);
  out.text(0x0020, 0x000e, "UI", ids.series);
  out.text(0x0020, 0x0010, "SH", "");
  out.text(0x0020, 0x0011, "IS", std::to_string(options.series_number));
  out.text(0x0020, 0x0012, "IS", "1");
  out.text(0x0020, 0x0013, "IS", std::to_string(k + 1));
  out.text(0x0020, 0x0032, "DS", decimal_texts(std::span(at.data(), 3)));
  out.text(0x0020, 0x0037, "DS", decimal_texts(directions));
  out.text(0x0020, 0x0052, "UI", ids.frame);
  out.text(0x0020, 0x1040, "LO", "");
  out.number(0x0028, 0x0002, 1);
  out.text(0x0028, 0x0004, "CS", "MONOCHROME2");
  out.number(0x0028, 0x0010, volume.size[1]);
  out.number(0x0028, 0x0011, volume.size[0]);
  out.text(0x0028, 0x0030, "DS", decimal_texts(spacing));
  for (const auto& [element, value] :
       {std::pair{0x0100u, 16}, {0x0101u, 16}, {0x0102u, 15}, {0x0103u, 0}})
    out.number(0x0028, element, value);
  out.text(0x0028, 0x1052, "DS", std::to_string(intercept));
  out.text(0x0028, 0x1053, "DS", "1");
  out.text(0x0028, 0x1054, "LO", "HU");
  out.block(0x7fe0, 0x0010, "OW", stored_values(volume, k));
}

std::string slice_file(const Volume& volume, int k, const SeriesIdentifiers& ids,
                       const CtWriteOptions& options) {
  const std::string instance = identifier(ids.content, 16 + static_cast<std::uint32_t>(k));
  ElementWriter out;
  out.text(0x0008, 0x0008, "CS", "DERIVED\\SECONDARY\\AXIAL");
  out.text(0x0008, 0x0016, "UI", ct_image_storage);
  out.text(0x0008, 0x0018, "UI", instance);
  for (const auto& [element, type] : {std::pair{0x0020u, "DA"}, {0x0030u, "TM"}, {0x0050u, "SH"}})
    out.text(0x0008, element, type, "");
  out.text(0x0008, 0x0060, "CS", "CT");
  out.text(0x0008, 0x0070, "LO", "Condyle");
  out.text(0x0008, 0x0090, "PN", "");
  for (const auto& [element, type] :
       {std::pair{0x0010u, "PN"}, {0x0020u, "LO"}, {0x0030u, "DA"}, {0x0040u, "CS"}})
    out.text(0x0010, element, type, "");
  out.text(0x0018, 0x0050, "DS", decimal_text(volume.spacing_mm.z()));
  out.text(0x0018, 0x0060, "DS", decimal_text(options.kvp));
  out.text(0x0018, 0x1210, "SH", options.kernel);
  write_plane(volume, k, ids, options, out);
  return file_meta(instance) + out.bytes();
}

}  // namespace

void write_ct_series(const Volume& volume, const std::filesystem::path& folder,
                     const CtWriteOptions& options) {
  const SeriesIdentifiers ids = identifiers_of(volume, options);
  AtomicOutput files(folder);
  for (int k = 0; k < volume.size[2]; ++k)
    files.write(fmt::format("slice-{:04}.dcm", k + 1), slice_file(volume, k, ids, options));
  files.finish();
}

}  // namespace condyle
