#pragma once

#include <string_view>

namespace condyle {

/// How a DICOM file is encoded.
struct TransferSyntax {
  const char* uid;
  const char* name;  // for people
  bool implicit_vr = false, big_endian = false, deflated = false, compressed = false, lossy = false;
  bool readable = true;
};

/// The syntax of this unique identifier; nullptr where it is unknown.
const TransferSyntax* transfer_syntax(std::string_view uid);

extern const TransferSyntax& implicit_little_endian;
extern const TransferSyntax& explicit_little_endian;

}  // namespace condyle
