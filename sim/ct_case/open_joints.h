#pragma once

#include "sim/case/case.h"

namespace condyle {

/// Moves skull and condyles apart where their surfaces touch: a gap of less than a voxel is closed
/// by the error of decimation. Returns the largest shift of a vertex, mm; 0 where they do not
/// touch.
double open_joints(Case& patient);

}  // namespace condyle
