#pragma once

#include <map>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The foremost crossings of a surface with a sagittal plane: y by height, in bins of z.
using FrontProfile = std::map<int, double>;

constexpr double profile_bin_mm = 0.5;

/// Height of the middle of a bin, mm.
inline double profile_height(int bin) { return (bin + 0.5) * profile_bin_mm; }

/// The profile in the plane x = x0; y points back. What lies more than 50 mm behind the foremost
/// point is left out.
FrontProfile front_profile(const TriMesh& mesh, double x0);

/// Depth of a point of the profile behind the prominences within 8 mm, the height of a lip, above
/// and below it, the lesser of the two; mm.
double hollow_depth(const FrontProfile& front, int bin, double y);

}  // namespace condyle
