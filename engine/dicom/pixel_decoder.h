#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/dicom/slice_header.h"

namespace condyle {

/// The pixels of a compressed slice, as many bytes as its header states, little endian.
/// throws: DicomDamage for data that is damaged or of another size than the header states, which is
/// compared before memory is requested. Nothing is printed. MachineError: see run_isolated().
std::string decompressed(const std::vector<std::string>& fragments, const SlicePixels& pixels);

}  // namespace condyle
