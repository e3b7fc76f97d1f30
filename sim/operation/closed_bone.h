#pragma once

#include <string>
#include <vector>

#include "sim/frame/part.h"

namespace condyle {

/// A bone that can be cut.
struct ClosedBone {
  TriMesh mesh;
  std::vector<int> source;         // triangle of the part, -1 where a hole was closed
  std::vector<std::string> notes;  // what was repaired
};

/// The part's mesh where its edges are balanced; else welded, oriented, with small holes closed.
/// throws: InputError with the number of edges that remain open or turned.
ClosedBone closed_bone(const Part& part);

}  // namespace condyle
