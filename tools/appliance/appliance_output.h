#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/appliance/guide.h"
#include "sim/appliance/splint.h"
#include "sim/case/case.h"
#include "tools/command.h"

/// What `splint` and `guide` share: options of their shape, files, reports and pictures.
namespace condyle {

struct ApplianceFiles {
  std::filesystem::path out, picture;
};

/// Adds --out and --picture.
void add_appliance_files(CLI::App& command, ApplianceFiles& files);

/// Refuses other extensions than .stl and .ply, and .png. throws: InputError.
void check_files(const ApplianceFiles& files);

/// Title and lines of a picture.
struct PictureText {
  std::string title, lines;
};

/// What a command tells about an appliance that it made.
struct ApplianceReport {
  std::string title, plan;  // "final splint", name of its plan
  std::string text;
  std::vector<std::string> notes;
  nlohmann::ordered_json json;
  std::function<void(const PictureText& text, const std::filesystem::path& file)> draw;
};

/// Writes the surface, beside the file and renamed, and the picture; prints the notes and the
/// results. throws: MachineError.
void finish_appliance(const TriMesh& mesh, const ApplianceReport& report,
                      const ApplianceFiles& files, const CommonOptions& common);

void add_length(CLI::App& command, const std::string& name, double& value_mm, const char* what,
                double low, double high);
/// Adds an option for each length of the appliance's shape.
template <class Settings, class Lengths>
void add_lengths(CLI::App& command, Settings& settings, const Lengths& lengths) {
  begin_group(command, "Shape");
  for (const ShapeLength<Settings>& each : lengths)
    add_length(command, each.name, settings.*each.value_mm, each.what, each.low, each.high);
}

/// The splint on the arches, and alone from above and below. `patient`: at that stage, with the
/// lower arch in its bite. throws: MachineError.
void write_splint_picture(const Splint& splint, const Case& patient, const PictureText& text,
                          const std::filesystem::path& file);

/// The guide on its bone from its own side and from beside, and alone from both sides.
/// throws: MachineError.
void write_guide_picture(const Guide& guide, const Case& patient, const PictureText& text,
                         const std::filesystem::path& file);

}  // namespace condyle
