#pragma once

#include <vector>

#include "engine/core/progress.h"
#include "engine/dicom/slice_stack.h"
#include "engine/volume/volume.h"

namespace condyle {

/// The volume of slices that are sorted by height. A sheared stack is shifted back into a larger
/// lattice; uneven slices are interpolated at the median step. throws: DicomDamage naming the file
/// by its number.
Volume assemble_volume(const std::vector<SliceHeader>& slices, const StackGeometry& stack,
                       int threads, const Progress& progress);

}  // namespace condyle
