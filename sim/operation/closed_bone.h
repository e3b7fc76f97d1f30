#pragma once

#include <string>
#include <vector>

#include "sim/frame/part.h"

namespace condyle {

/// A bone that can be cut.
struct ClosedBone {
  TriMesh mesh;
  std::vector<int> source;         // triangle of the part, -1 where an opening was closed
  std::vector<std::string> notes;  // what was repaired
};

/// A wrapped surface may lie so far from points of the part's outer surface.
constexpr double most_wrapped_mm = 1.5;

/// The part's mesh where its edges are balanced; else welded, oriented, with flat scan ends and
/// small holes closed; where that is not enough, wrapped (see wrap()), with a note of the distance.
/// A wrapped surface is kept for the next cut of the same mesh.
/// throws: InputError where the wrapped surface is not one solid or lies farther than
/// most_wrapped_mm from the part.
ClosedBone closed_bone(const Part& part);

}  // namespace condyle
