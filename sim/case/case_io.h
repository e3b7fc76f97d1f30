#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/case/source_frame.h"

namespace condyle {

struct ImportFile {
  Role role;
  std::filesystem::path file;
};

struct ImportRequest {
  std::vector<ImportFile> files;    // at least one bone; a role may occur several times
  std::filesystem::path landmarks;  // CSV or .mrk.json; empty = none
  SourceFrame source = {};          // unit and axes of the files
  std::string name;
  std::optional<double> scan_opening_mm = {};  // see Case
  // Parent bodies of pieces, by the piece's name (segment, segment-2, ...): the cranium, the
  // mandible or another piece; by default the cranium or mandible, whichever is nearer.
  std::map<std::string, std::string> parents = {};
  // In millimetres regardless of the units of the surfaces, with the same axes; empty = none.
  std::filesystem::path muscles = {};       // CSV, see sim/case/muscle_table.h
  std::filesystem::path face_muscles = {};  // CSV, see sim/case/face_muscle_table.h
  std::filesystem::path mechanics = {};     // JSON, see sim/case/jaw_mechanics.h
};

/// Reads the files, converts them to LPS mm, checks and repairs them where possible; `notes` of the
/// result list what was found, repaired and estimated. Several files of one dental arch become one
/// part (a Tooth per file named by its FDI number, as tooth_36.ply); several files of another role
/// become separate parts, skull, skull-2. Unused vertices are removed. throws: InputError.
Case import_meshes(const ImportRequest& request);

/// Landmarks file (CSV `name,x_mm,y_mm,z_mm`, or 3D Slicer .mrk.json), with canonical names.
Landmarks read_landmarks(const std::filesystem::path& file);

/// Whether the case.json in a folder belongs to another program: JSON without this program's format
/// name. False without such a file, or where it cannot be read.
bool has_foreign_case_file(const std::filesystem::path& folder);

/// Loads a case folder: case.json, one binary PLY per part, landmarks.csv. Only files inside the
/// folder are read. Loading is bit-identical to what was saved. throws: InputError.
Case load_case(const std::filesystem::path& folder);

/// Writes to a temporary folder and swaps: a failed save leaves the earlier case intact. A folder
/// that contains anything but a case is refused. throws: InputError, MachineError.
void save_case(const Case& patient, const std::filesystem::path& folder);

std::string role_name(Role role);  // "upper-teeth"
std::optional<Role> role_named(const std::string& name);
std::string known_roles();  // "skull, maxilla, ...", for messages

}  // namespace condyle
