#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/case/source_frame.h"

namespace condyle {

/// A scanned face: LPS axes, mm, in the scanner's own frame; welded, facing outward, with the
/// scanner's colours where it gave some.
struct FaceScan {
  TriMesh mesh;
  std::vector<std::string> notes;  // what was found and repaired
};

/// Reads a depth map by its description (.json), or a surface (.ply, .stl, .obj, .glb) with its
/// texture or colours per vertex. Pieces smaller than a tenth of the largest one are dropped. A
/// surface whose size fits a head in metres or centimetres alone is refused with the unit.
/// throws: InputError.
FaceScan read_face_scan(const std::filesystem::path& file, const SourceFrame& frame = {});

}  // namespace condyle
