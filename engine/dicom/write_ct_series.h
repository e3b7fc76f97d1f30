#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/volume/volume.h"

namespace condyle {

struct CtWriteOptions {
  int series_number = 1;
  std::uint64_t study = 0;  // volumes of one study have the same number
  std::string kernel = "STANDARD";
  double kvp = 120;
};

/// Writes each slice as an uncompressed DICOM file slice-0001.dcm of one CT series. Identifiers are
/// made of the content alone, so that the same volume gives the same bytes; there are no names and
/// no dates. Values below -1024 HU are written as -1024. throws: MachineError.
void write_ct_series(const Volume& volume, const std::filesystem::path& folder,
                     const CtWriteOptions& options = {});

}  // namespace condyle
