#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The surface of one dental arch as an intraoral or model scanner gives it: crowns and gum, mostly
/// open below, in the scanner's own frame.
struct DentalScan {
  std::string source;   // file name, for messages
  TriMesh mesh;         // welded, facing outward; scanner's frame, mm
  bool inward = false;  // its triangles faced inward, as those of a mirrored surface do
  std::vector<std::string> notes;
};

/// Cleans a surface: welds, orients, drops loose pieces. throws: InputError where nothing is left
/// or the size is not that of a dental arch (a part of one, where `partial`), naming the unit that
/// would fit.
DentalScan dental_scan(TriMesh mesh, const std::filesystem::path& file, bool partial = false);

/// The same from a file (STL, PLY, OBJ, GLB). throws: InputError as read_mesh().
DentalScan read_dental_scan(const std::filesystem::path& file, double unit_mm,
                            bool partial = false);

}  // namespace condyle
