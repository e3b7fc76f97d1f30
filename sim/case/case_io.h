#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/case/case.h"

namespace condyle {

struct ImportFile {
  Role role;
  std::filesystem::path file;
};

struct ImportRequest {
  std::vector<ImportFile> files;           // one bone at least; a role may come several times
  std::filesystem::path landmarks;         // CSV or .mrk.json; empty = none
  std::string units = "mm";                // mm m cm in
  std::string frame = "LPS";               // any of the 48 signed axis orders: LPS, RAS, ...
  std::string name;
};

/// Reads, converts to LPS mm, checks and repairs what can be. throws: InputError.
Case import_meshes(const ImportRequest& request);

/// Landmarks file (CSV `name,x_mm,y_mm,z_mm`, or 3D Slicer .mrk.json), names made canonical.
Landmarks read_landmarks(const std::filesystem::path& file);

/// A case folder: case.json, one binary PLY per part, landmarks.csv. Files inside the folder only.
Case load_case(const std::filesystem::path& folder);
void save_case(const Case& patient, const std::filesystem::path& folder);

std::string role_name(Role role);  // "upper-teeth"

}  // namespace condyle
