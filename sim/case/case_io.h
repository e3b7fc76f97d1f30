#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/case.h"

namespace condyle {

struct ImportFile {
  Role role;
  std::filesystem::path file;
};

struct ImportRequest {
  std::vector<ImportFile> files;    // one bone at least; a role may come several times
  std::filesystem::path landmarks;  // CSV or .mrk.json; empty = none
  std::string units = "mm";         // mm m cm in
  std::string frame = "LPS";        // any of the 48 signed axis orders: LPS, RAS, ...
  std::string name;
  // Carriers of free parts by name (segment, segment-2, transplant, ...); of others the body that
  // is nearer.
  std::map<std::string, Body> carriers = {};
  // In millimetres whatever the units of the surfaces, axes as these; empty = none.
  std::filesystem::path muscles = {};    // CSV, as sim/case/muscle_table.h tells
  std::filesystem::path mechanics = {};  // JSON, as sim/case/jaw_mechanics.h tells
};

/// Reads, converts to LPS mm, checks and repairs what can be; `notes` of the result say what was
/// found, repaired and estimated. Several files of one arch of teeth become one part (a Tooth per
/// file named by its FDI number, as tooth_36.ply); several files of another role become parts of
/// their own, skull, skull-2. Unused vertices go. throws: InputError.
Case import_meshes(const ImportRequest& request);

/// Landmarks file (CSV `name,x_mm,y_mm,z_mm`, or 3D Slicer .mrk.json), names made canonical.
Landmarks read_landmarks(const std::filesystem::path& file);

/// Whether the case.json in a folder is of another program: JSON that does not call itself a case of
/// this one. Without such a file, or where it cannot be read, false.
bool has_foreign_case_file(const std::filesystem::path& folder);

/// A case folder: case.json, one binary PLY per part, landmarks.csv. Files inside the folder only.
/// Loading gives the bits that were saved. throws: InputError.
Case load_case(const std::filesystem::path& folder);

/// Writes beside the folder and swaps: a failed save leaves the earlier case whole. A folder that
/// holds anything but a case is refused. throws: InputError, MachineError.
void save_case(const Case& patient, const std::filesystem::path& folder);

std::string role_name(Role role);  // "upper-teeth"
std::optional<Role> role_named(const std::string& name);
/// "cranium", "mandible": what a free part goes along with.
std::string carrier_name(Body carrier);
std::optional<Body> carrier_named(const std::string& name);
std::string known_roles();  // "skull, maxilla, ...", for messages

}  // namespace condyle
