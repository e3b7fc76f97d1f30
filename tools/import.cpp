#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "sim/case/case_format.h"
#include "sim/case/case_io.h"
#include "sim/contact/push_out_parts.h"
#include "sim/motion/closed_position.h"
#include "tools/commands.h"
#include "tools/pair_options.h"

namespace condyle {
namespace {

struct ImportOptions {
  std::string units = "mm", frame = "LPS";  // of the files, unparsed
  ImportRequest request;
  std::vector<std::string> carriers;
  bool push_out = false;  // pieces that start deep inside others
  std::filesystem::path out;
};

int run_import(const ImportOptions& options, const CommonOptions& common) {
  ImportRequest request = options.request;
  request.parents = parse_parents(options.carriers);
  request.source = source_frame(options.units, options.frame);
  if (request.name.empty()) request.name = (options.out / "").parent_path().filename().string();
  Case patient = import_meshes(request);
  report_scan_opening(patient);
  if (options.push_out) push_out_pieces(patient);
  save_case(patient, options.out);
  if (common.json) {
    nlohmann::ordered_json json = {{"case", options.out.string()}, {"name", patient.name}};
    for (const auto& part : patient.parts)
      json["parts"].push_back({{"name", part.name},
                               {"role", role_name(part.role)},
                               {"triangles", part.mesh.triangles.size()}});
    json["landmarks"] = patient.landmarks.points.size();
    json["notes"] = patient.notes;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }
  if (common.prints_summary()) {
    for (const auto& note : patient.notes) fmt::print(stderr, "note: {}\n", note);
    const bool moves = patient.landmarks.find("lower_incisal_point") &&
                       std::any_of(patient.parts.begin(), patient.parts.end(),
                                   [](const Part& part) { return part.role == Role::mandible; });
    fmt::print(stderr, "{}: {} part{}, {} landmarks. Next: condyle {} {}{}\n", options.out.string(),
               patient.parts.size(), patient.parts.size() == 1 ? "" : "s",
               patient.landmarks.points.size(), moves ? "record" : "view", options.out.string(),
               moves ? " --motion opening --out out --film" : "");
  }
  return 0;
}

void add_surfaces(CLI::App& command, ImportOptions& options) {
  constexpr std::array roles = {std::pair{"--skull", Role::skull},
                                std::pair{"--maxilla", Role::maxilla},
                                std::pair{"--mandible", Role::mandible},
                                std::pair{"--upper-teeth", Role::upper_teeth},
                                std::pair{"--lower-teeth", Role::lower_teeth},
                                std::pair{"--face", Role::face},
                                std::pair{"--segment", Role::segment},
                                std::pair{"--transplant", Role::transplant}};
  begin_group(command,
              "Surfaces (STL, PLY, OBJ or GLB files; each option may be given several times)");
  for (const auto& [name, role] : roles)
    command
        .add_option_function<std::vector<std::filesystem::path>>(
            name,
            [&options, role = role](const std::vector<std::filesystem::path>& files) {
              for (const auto& file : files) options.request.files.push_back({role, file});
            },
            "")
        ->type_name("FILE");
}

void add_meshes(Commands& commands, CLI::App& import) {
  const auto options = std::make_shared<ImportOptions>();
  ImportRequest& request = options->request;
  CLI::App& command = commands.add_below(
      import, "meshes", "From surfaces: STL, PLY, OBJ or GLB",
      "condyle import meshes --mandible jaw.stl --maxilla maxilla.ply --face skin.obj\n"
      "      --landmarks marks.csv --units m --frame RAS --out mycase",
      [options](const CommonOptions& common) { return run_import(*options, common); });
  command.add_option("--out", options->out, "Folder of the new case")
      ->type_name("FOLDER")
      ->required();
  command.add_option("--name", request.name, "Name of the case")->type_name("TEXT");
  command.add_option("--units", options->units, "Unit of the files; default mm")
      ->type_name("mm|cm|m|in");
  command.add_option("--frame", options->frame, "Axes of the files: LPS (the default), RAS, ...")
      ->type_name("AXES");
  command
      .add_option("--landmarks", request.landmarks,
                  "CSV with name,x_mm,y_mm,z_mm, or 3D Slicer .mrk.json")
      ->type_name("FILE");
  in_range(command.add_option("--scan-opening", request.scan_opening_mm,
                              "Scanned with the mouth open: depth of the lower incisal point below "
                              "its closed position, mm; default: found from the teeth"),
           0, max_scan_opening_mm);
  add_surfaces(command, *options);
  begin_group(command, "Segments and transplants");
  command
      .add_option("--carrier-of", options->carriers,
                  "The body with which a segment or transplant moves, e.g. segment-2=mandible; "
                  "default the nearer one")
      ->type_name("NAME=BODY");
  command.add_flag("--push-out", options->push_out,
                   "Move segments and transplants that start deep inside a bone out of it");
  begin_group(command, "Muscles");
  command
      .add_option("--muscles", request.muscles,
                  "CSV of muscles: name, origin_body, insertion_body, ox_mm, oy_mm, oz_mm, ix_mm, "
                  "iy_mm, iz_mm, max_force_N and more")
      ->type_name("FILE");
  command
      .add_option(
          "--face-muscles", request.face_muscles,
          "CSV of the muscles of facial expression: muscle, side, fibre, point, x_mm, y_mm, "
          "z_mm and more")
      ->type_name("FILE");
  command
      .add_option("--mechanics", request.mechanics,
                  "JSON of the jaw as a rigid body: mass, inertia, damping, guide of the condyles")
      ->type_name("FILE");
}

}  // namespace

void add_import(Commands& commands) {
  CLI::App& import = commands.add_parent(
      "import", "Make a case from your files",
      "condyle import meshes --mandible jaw.stl --maxilla maxilla.stl --out mycase\n"
      "  condyle import ct scan --list\n"
      "  condyle import teeth patient --upper upper.stl --lower lower.stl --out patient-teeth");
  add_meshes(commands, import);
  add_import_ct(commands, import);
  add_import_face(commands, import);
  add_import_teeth(commands, import);
}

}  // namespace condyle
