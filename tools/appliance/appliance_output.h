#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/appliance/guide.h"
#include "sim/appliance/splint.h"
#include "sim/case/case.h"
#include "tools/command.h"

/// What `splint` and `guide` share: their files and pictures.
namespace condyle {

struct ApplianceFiles {
  std::filesystem::path out, picture;
};

/// Adds --out and --picture.
void add_appliance_files(CLI::App& command, ApplianceFiles& files);

/// Refuses other extensions than .stl and .ply, and .png. throws: InputError.
void check_files(const ApplianceFiles& files);

/// Written beside the file and renamed. throws: MachineError.
void write_appliance(const TriMesh& mesh, const ApplianceFiles& files);

/// Title and lines of a picture.
struct PictureText {
  std::string title, lines;
};

/// The splint on the arches, and alone from above and below. `patient`: at that stage, with the
/// lower arch in its bite. throws: MachineError.
void write_splint_picture(const Splint& splint, const Case& patient, const PictureText& text,
                          const std::filesystem::path& file);

/// The guide on its bone from its own side and from beside, and alone from both sides.
/// throws: MachineError.
void write_guide_picture(const Guide& guide, const Case& patient, const PictureText& text,
                         const std::filesystem::path& file);

}  // namespace condyle
