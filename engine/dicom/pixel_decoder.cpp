#include "engine/dicom/pixel_decoder.h"

#include <gdcmBitmap.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <optional>

#include "engine/dicom/isolated.h"

namespace condyle {
namespace {

struct StreamSize {
  std::uint32_t rows = 0, columns = 0, components = 0;
};

std::uint32_t big(std::string_view bytes, std::size_t at, std::size_t count) {
  if (at + count > bytes.size()) throw DicomDamage("holds damaged compressed pixels");
  return dicom_number(bytes.substr(at, count), true);
}

/// The size that a JPEG or JPEG-LS stream states itself.
StreamSize jpeg_size(std::string_view stream) {
  for (std::size_t at = 2;;) {
    while (big(stream, at, 2) == 0xffff) ++at;  // filling
    const std::uint32_t marker = big(stream, at, 2);
    const bool frame = (marker >= 0xffc0 && marker <= 0xffcf && marker != 0xffc4 &&
                        marker != 0xffc8 && marker != 0xffcc) ||
                       marker == 0xfff7;
    if (frame) return {big(stream, at + 5, 2), big(stream, at + 7, 2), big(stream, at + 9, 1)};
    at += 2 + big(stream, at + 2, 2);
  }
}

/// The same of JPEG 2000: the codestream alone or in its file format.
StreamSize jpeg_2000_size(std::string_view stream) {
  const std::size_t begin = stream.find(std::string_view("\xff\x4f\xff\x51", 4));
  if (begin == std::string_view::npos) throw DicomDamage("holds damaged compressed pixels");
  const std::size_t size = begin + 8;
  const auto extent = [&](std::size_t at) {
    const std::uint32_t end = big(stream, size + at, 4), start = big(stream, size + at + 8, 4);
    return end > start ? end - start : 0;
  };
  return {extent(4), extent(0), big(stream, size + 32, 2)};
}

/// The size that the compressed stream states itself; none for RLE, which states none.
std::optional<StreamSize> stream_size(std::string_view stream, std::string_view uid) {
  if (uid == "1.2.840.10008.1.2.5") return std::nullopt;
  if (uid == "1.2.840.10008.1.2.4.90" || uid == "1.2.840.10008.1.2.4.91")
    return jpeg_2000_size(stream);
  return jpeg_size(stream);
}

/// Compares the stream's own size with that of the header, and looks for its end.
void check_stream(const std::vector<std::string>& fragments, const SlicePixels& pixels) {
  constexpr std::size_t most_padding = 16;
  const auto size = stream_size(fragments.at(0), pixels.syntax->uid);
  if (!size) return;
  if (size->rows != static_cast<std::uint32_t>(pixels.rows) ||
      size->columns != static_cast<std::uint32_t>(pixels.columns) || size->components != 1)
    throw DicomDamage("holds compressed pixels of another size than its header states");
  const std::string_view last = fragments.back();
  const std::string_view first = fragments.front();
  const bool bare = first.starts_with("\xff\x4f") || first.starts_with("\xff\xd8");
  if (bare && last.substr(last.size() - std::min(last.size(), most_padding)).find("\xff\xd9") ==
                  std::string_view::npos)
    throw DicomDamage("has compressed pixels that end early");
}

gdcm::Bitmap bitmap_of(const std::vector<std::string>& fragments, const SlicePixels& pixels) {
  gdcm::SmartPointer<gdcm::SequenceOfFragments> sequence = new gdcm::SequenceOfFragments;
  for (const std::string& bytes : fragments) {
    gdcm::Fragment fragment;
    fragment.SetByteValue(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    sequence->AddFragment(fragment);
  }
  gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
  element.SetVR(gdcm::VR::OB);
  element.SetValue(*sequence);
  gdcm::Bitmap bitmap;
  bitmap.SetNumberOfDimensions(2);
  bitmap.SetDimension(0, static_cast<unsigned>(pixels.columns));
  bitmap.SetDimension(1, static_cast<unsigned>(pixels.rows));
  const auto bits = [](int n) { return static_cast<unsigned short>(n); };
  bitmap.SetPixelFormat(gdcm::PixelFormat(1, bits(pixels.bits_allocated), bits(pixels.bits_stored),
                                          bits(pixels.high_bit), pixels.is_signed ? 1 : 0));
  bitmap.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  bitmap.SetTransferSyntax(gdcm::TransferSyntax::GetTSType(pixels.syntax->uid));
  bitmap.SetLossyFlag(pixels.syntax->lossy);
  bitmap.SetDataElement(element);
  return bitmap;
}

}  // namespace

std::string decompressed(const std::vector<std::string>& fragments, const SlicePixels& pixels) {
  check_stream(fragments, pixels);
  // On damaged data GDCM 3.0 crashes (RLE), fails assertions and prints (JPEG).
  const auto result = run_isolated(pixels.bytes(), [&](char* buffer) {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    const gdcm::Bitmap bitmap = bitmap_of(fragments, pixels);
    return bitmap.GetBufferLength() == pixels.bytes() && bitmap.GetBuffer(buffer);
  });
  // Its JPEG decoder goes on after it has found an error.
  if (!result || result->messages.find("Corrupt") != std::string::npos ||
      result->messages.find("Premature end") != std::string::npos)
    throw DicomDamage("holds damaged compressed pixels");
  return result->output;
}

}  // namespace condyle
