#include "engine/dicom/transfer_syntax.h"

#include <algorithm>
#include <iterator>

// source: DICOM PS3.6, annex A

namespace condyle {
namespace {

constexpr TransferSyntax syntaxes[] = {
    {.uid = "1.2.840.10008.1.2", .name = "uncompressed", .implicit_vr = true},
    {.uid = "1.2.840.10008.1.2.1", .name = "uncompressed"},
    {.uid = "1.2.840.10008.1.2.2", .name = "uncompressed, big endian", .big_endian = true},
    {.uid = "1.2.840.10008.1.2.1.99", .name = "deflated", .deflated = true},
    {.uid = "1.2.840.10008.1.2.5", .name = "RLE", .compressed = true},
    {.uid = "1.2.840.10008.1.2.4.50", .name = "lossy JPEG", .compressed = true, .lossy = true},
    {.uid = "1.2.840.10008.1.2.4.51", .name = "lossy JPEG", .compressed = true, .lossy = true},
    {.uid = "1.2.840.10008.1.2.4.57", .name = "lossless JPEG", .compressed = true},
    {.uid = "1.2.840.10008.1.2.4.70", .name = "lossless JPEG", .compressed = true},
    {.uid = "1.2.840.10008.1.2.4.80", .name = "lossless JPEG-LS", .compressed = true},
    {.uid = "1.2.840.10008.1.2.4.81",
     .name = "near-lossless JPEG-LS",
     .compressed = true,
     .lossy = true},
    {.uid = "1.2.840.10008.1.2.4.90", .name = "lossless JPEG 2000", .compressed = true},
    {.uid = "1.2.840.10008.1.2.4.91", .name = "JPEG 2000", .compressed = true, .lossy = true},
    {.uid = "1.2.840.10008.1.2.4.201", .name = "HTJ2K", .compressed = true, .readable = false},
    {.uid = "1.2.840.10008.1.2.4.202", .name = "HTJ2K", .compressed = true, .readable = false},
    {.uid = "1.2.840.10008.1.2.4.203", .name = "HTJ2K", .compressed = true, .readable = false},
    {.uid = "1.2.840.10008.1.2.4.92", .name = "JPEG 2000 part 2", .readable = false},
    {.uid = "1.2.840.10008.1.2.4.93", .name = "JPEG 2000 part 2", .readable = false},
    {.uid = "1.2.840.10008.1.2.4.100", .name = "MPEG-2 video", .readable = false},
    {.uid = "1.2.840.10008.1.2.4.110", .name = "JPEG XL", .readable = false},
    {.uid = "1.2.840.10008.1.2.4.111", .name = "JPEG XL", .readable = false},
    {.uid = "1.2.840.10008.1.2.4.112", .name = "JPEG XL", .readable = false},
    {.uid = "1.2.840.113619.5.2", .name = "GE private", .implicit_vr = true, .readable = false},
};

}  // namespace

const TransferSyntax& implicit_little_endian = syntaxes[0];
const TransferSyntax& explicit_little_endian = syntaxes[1];

const TransferSyntax* transfer_syntax(std::string_view uid) {
  const auto* const found =
      std::find_if(std::begin(syntaxes), std::end(syntaxes),
                   [&](const TransferSyntax& each) { return uid == each.uid; });
  return found == std::end(syntaxes) ? nullptr : found;
}

}  // namespace condyle
