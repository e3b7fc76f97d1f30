#include "engine/dicom/slice_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/dicom/pixel_decoder.h"

namespace condyle {
namespace {

constexpr double highest_ct_hu = 3071;  // of 12 bits

/// The bytes of the pixels as they are stored: one text, or the fragments.
std::vector<std::string> stored_pixels(const SliceHeader& slice) {
  auto bytes = open_dicom(slice.file);
  if (!bytes) throw DicomDamage("cannot be read");
  const PixelLocation& location = slice.pixels.location;
  if (!location.fragments) return {std::string(bytes->read(location.begin, slice.pixels.bytes()))};
  std::vector<std::string> stored;
  for (const PixelLocation& fragment : pixel_fragments(*bytes, location.begin))
    stored.emplace_back(bytes->read(fragment.begin, static_cast<std::size_t>(fragment.length)));
  return stored;
}

/// Hounsfield units of stored bits, for each bit pattern that 16 bits can have.
class HounsfieldTable {
 public:
  explicit HounsfieldTable(const SlicePixels& pixels)
      : units_(std::size_t{1} << pixels.bits_allocated) {
    const int above = 31 - pixels.high_bit, below = 32 - pixels.bits_stored;
    for (std::size_t bits = 0; bits < units_.size(); ++bits) {
      const std::uint32_t left = static_cast<std::uint32_t>(bits) << above;
      const double value = pixels.is_signed
                               ? static_cast<double>(static_cast<std::int32_t>(left) >> below)
                               : static_cast<double>(left >> below);
      units_[bits] = in_hounsfield(value, pixels);
    }
  }
  std::int16_t operator[](std::size_t bits) const { return units_[bits]; }

 private:
  static std::int16_t in_hounsfield(double value, const SlicePixels& pixels) {
    const double hu = pixels.slope * value + pixels.intercept;
    // Padding above the range of CT is outside the picture, too; within it, it may be tissue.
    if (pixels.padding_hu && hu == *pixels.padding_hu && hu > highest_ct_hu) return air_hu;
    constexpr double high = std::numeric_limits<std::int16_t>::max();
    return static_cast<std::int16_t>(std::round(std::clamp(hu, double{air_hu}, high)));
  }
  std::vector<std::int16_t> units_;
};

}  // namespace

std::vector<std::int16_t> read_slice(const SliceHeader& slice) {
  const SlicePixels& pixels = slice.pixels;
  std::vector<std::string> stored = stored_pixels(slice);
  const std::string bytes =
      pixels.location.fragments ? decompressed(stored, pixels) : std::move(stored[0]);
  const HounsfieldTable table(pixels);
  const std::size_t width = static_cast<std::size_t>(pixels.bits_allocated) / 8;
  const bool high_first = pixels.syntax->big_endian;
  std::vector<std::int16_t> values(bytes.size() / width);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view one(bytes.data() + i * width, width);
    values[i] = table[dicom_number(one, high_first)];
  }
  return values;
}

bool have_equal_pixels(const SliceHeader& a, const SliceHeader& b) {
  return stored_pixels(a) == stored_pixels(b);
}

}  // namespace condyle
