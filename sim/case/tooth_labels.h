#pragma once

#include <limits>

#include "sim/frame/part.h"

namespace condyle {

/// Teeth with another surface: the triangles are sorted by the nearest tooth of `labelled`, whose
/// name, role and body it gets. Triangles farther than `reach_mm` from all teeth come last, without
/// a number.
Part with_tooth_labels(TriMesh mesh, const Part& labelled,
                       double reach_mm = std::numeric_limits<double>::infinity());

}  // namespace condyle
