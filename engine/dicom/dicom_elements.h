#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/dicom/dicom_bytes.h"
#include "engine/dicom/transfer_syntax.h"

namespace condyle {

/// Group and element, as (0x0020, 0x0032).
constexpr std::uint32_t dicom_tag(std::uint32_t group, std::uint32_t element) {
  return group << 16 | element;
}

/// The values of a data set's top level that are requested, as they are stored.
using DicomValues = std::map<std::uint32_t, std::string>;

/// Where the pixels are stored.
struct PixelLocation {
  std::uint64_t begin = 0;
  std::uint64_t length = 0;  // as the file states; unknown where `fragments`
  bool fragments = false;    // compressed
};

struct DicomElements {
  const TransferSyntax* syntax = nullptr;
  bool known_syntax = true;  // false: the syntax is inferred from the first element
  DicomValues values;
  std::optional<PixelLocation> pixels;
  std::string damage;  // not empty: the header could be read as far as here
};

/// The bytes of a DICOM file, uncompressed where its syntax is deflated; none for other files.
/// throws: DicomDamage for a file that is unreadable, or deflated and damaged.
std::optional<DicomBytes> open_dicom(const std::filesystem::path& file);

/// The requested values of a file of open_dicom(), up to its pixels. Lengths are compared with the
/// file before anything is read; sequences are not entered.
DicomElements read_elements(DicomBytes& bytes, const std::vector<std::uint32_t>& tags);

/// Begin and length of each fragment of compressed pixels, without the table of offsets.
/// throws: DicomDamage where they do not end.
std::vector<PixelLocation> pixel_fragments(DicomBytes& bytes, std::uint64_t begin);

/// A number of two or four bytes.
std::uint32_t dicom_number(std::string_view bytes, bool big_endian);

}  // namespace condyle
