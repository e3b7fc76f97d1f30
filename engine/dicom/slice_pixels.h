#pragma once

#include <cstdint>
#include <vector>

#include "engine/dicom/slice_header.h"

namespace condyle {

constexpr std::int16_t air_hu = -1024;

/// Rows x columns whole Hounsfield units by the slice's own rescale, the columns fastest. Lower
/// values and padding become -1024. throws: DicomDamage.
std::vector<std::int16_t> read_slice(const SliceHeader& slice);

/// Whether two files hold the same stored pixels. throws: DicomDamage.
bool have_equal_pixels(const SliceHeader& a, const SliceHeader& b);

}  // namespace condyle
