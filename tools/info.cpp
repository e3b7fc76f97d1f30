#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/user_cache.h"
#include "engine/dicom/ct_volume.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/volume/volume_files.h"
#include "sim/case/case_io.h"
#include "sim/dynamics/body_mass.h"
#include "sim/phantom/head_shape.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/stored_tissue.h"
#include "sim/tissue/tissue_memory.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/series_list.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

Json describe(const TriMesh& mesh) {
  const Topology topology = inspect(mesh);
  const auto [low, high] = bounding_box(mesh);
  return {{"vertices", mesh.vertices.size()},
          {"triangles", mesh.triangles.size()},
          {"components", topology.components},
          {"closed", topology.closed()},
          {"boundary_edges", topology.boundary_edges},
          {"non_manifold_edges", topology.nonmanifold_edges},
          {"low_mm", {low.x(), low.y(), low.z()}},
          {"high_mm", {high.x(), high.y(), high.z()}}};
}

Json describe(const Case& patient, BodyId id) {
  const Body& body = patient.bodies[id];
  Json json = {{"name", body.name}};
  if (id != cranium_body) {
    json["parent"] = patient.bodies[body.parent].name;
    json["driver"] = driver_name(body.driver);
  }
  json["parts"] = Json::array();
  bool bone = false;
  for (const Part& part : patient.parts) {
    if (part.body != id) continue;
    json["parts"].push_back(part.name);
    bone = bone || (collides(part.role) && !part.mesh.empty());
  }
  // The cranium is fixed, so its mass is irrelevant.
  if (bone && id != cranium_body) json["mass_g"] = 1000 * body_mass(patient, id).mass_kg;
  return json;
}

Json describe(const Case& patient, const Canal& canal) {
  double length = 0;
  for (std::size_t i = 1; i < canal.points.size(); ++i)
    length += (canal.points[i] - canal.points[i - 1]).norm();
  return {{"name", canal.name},
          {"body", patient.bodies[canal.body].name},
          {"diameter_mm", canal.diameter_mm},
          {"length_mm", length}};
}

std::string body_line(const Json& body) {
  std::string text = body["name"].get<std::string>();
  if (body.contains("parent")) {
    const std::string driver = body["driver"].get<std::string>();
    text += fmt::format(": on {}, {}", body["parent"].get<std::string>(),
                        driver == "fixed" ? driver : "moved by " + driver);
  }
  if (body.contains("mass_g")) text += fmt::format(", {:.1f} g", body["mass_g"].get<double>());
  return text;
}

std::string line(const Json& mesh) {
  const auto& low = mesh["low_mm"];
  const auto& high = mesh["high_mm"];
  return fmt::format(
      "{:>7} triangles, {}{}; {:.1f} x {:.1f} x {:.1f} mm", mesh["triangles"].get<int>(),
      mesh["closed"].get<bool>()
          ? "closed"
          : fmt::format("open ({} boundary edges)", mesh["boundary_edges"].get<int>()),
      mesh["components"].get<int>() > 1 ? fmt::format(", {} pieces", mesh["components"].get<int>())
                                        : "",
      high[0].get<double>() - low[0].get<double>(), high[1].get<double>() - low[1].get<double>(),
      high[2].get<double>() - low[2].get<double>());
}

Json describe(const Volume& volume) {
  const auto [low, high] = std::minmax_element(volume.values.begin(), volume.values.end());
  const auto list = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  Json json{{"size", volume.size},
            {"spacing_mm", list(volume.spacing_mm)},
            {"origin_mm", list(volume.origin)},
            {"lowest_hu", *low},
            {"highest_hu", *high}};
  for (int a = 0; a < 3; ++a) {
    json["axes"].push_back(list(volume.axes.col(a)));
    json["extent_mm"].push_back(volume.size[static_cast<std::size_t>(a)] * volume.spacing_mm[a]);
  }
  return json;
}

/// The direction in which most of an axis points.
char letter_of(const Eigen::Vector3d& axis) {
  int most = 0;
  axis.cwiseAbs().maxCoeff(&most);
  return (axis[most] > 0 ? "LPS" : "RAI")[most];
}

std::string line(const Volume& volume) {
  const Json json = describe(volume);
  const Eigen::Vector3d& spacing = volume.spacing_mm;
  std::string letters;
  for (int a = 0; a < 3; ++a) letters += letter_of(volume.axes.col(a));
  return fmt::format(
      "{} x {} x {} values, {:.3g} x {:.3g} x {:.3g} mm apart, {:.0f} x {:.0f} x {:.0f} mm in all; "
      "axes toward {}; {} to {} HU",
      volume.size[0], volume.size[1], volume.size[2], spacing.x(), spacing.y(), spacing.z(),
      json["extent_mm"][0].get<double>(), json["extent_mm"][1].get<double>(),
      json["extent_mm"][2].get<double>(), letters, json["lowest_hu"].get<int>(),
      json["highest_hu"].get<int>());
}

struct InfoOptions {
  std::filesystem::path what;
  bool tissue = false;
  int surface_nodes = TissueSettings{}.surface_nodes;
};

/// Size of the patient's soft tissue. throws: InputError for a patient without a face.
Json tissue_size(Case patient, const InfoOptions& options, const CommonOptions& common,
                 ProgressBar& bar) {
  part_lips(patient);
  TissueSettings settings;
  settings.surface_nodes = options.surface_nodes;
  settings.threads = common.threads;
  const auto tissue = stored_tissue(user_cache_folder(), patient, settings, bar.callback());
  if (!tissue) throw InputError("--tissue: " + patient.name + " has no face");
  const TissueSummary& made = summary(*tissue);
  const TissueMemory memory = memory_of(*tissue);
  return {{"nodes", made.nodes},
          {"springs", made.springs},
          {"prisms", made.prisms},
          {"bytes_per_node", static_cast<double>(memory.tissue) / made.nodes},
          {"bytes", memory.tissue},
          {"displayed_face_bytes", memory.displayed_face},
          {"bone_surface_bytes", memory.bone_surfaces},
          {"stored_factors",
           {{"made", memory.factors_made},
            {"bytes", memory.factors},
            {"most", memory.factors_most},
            {"most_bytes", memory.most_factors()}}}};
}

std::string tissue_lines(const Json& json) {
  const auto MB = [](const Json& bytes) { return bytes.get<double>() / 1e6; };
  const Json& factors = json["stored_factors"];
  return fmt::format(
      "  soft tissue: {} nodes, {} springs, {} prisms; {:.2f} kB a node ({:.1f} MB), displayed "
      "face {:.1f} MB, bones that it touches {:.1f} MB\n"
      "    stored factors: {} of {} made, {:.1f} MB; all would take {:.1f} MB\n",
      json["nodes"].get<int>(), json["springs"].get<int>(), json["prisms"].get<int>(),
      json["bytes_per_node"].get<double>() / 1e3, MB(json["bytes"]),
      MB(json["displayed_face_bytes"]), MB(json["bone_surface_bytes"]), factors["made"].get<int>(),
      factors["most"].get<int>(), MB(factors["bytes"]), MB(factors["most_bytes"]));
}

int run_info(const InfoOptions& options, const CommonOptions& common) {
  const std::filesystem::path& what = options.what;
  if (options.tissue && !what.empty() && !is_head_name(what.string()) &&
      (!std::filesystem::is_directory(what) || holds_dicom(what)))
    throw InputError("--tissue: " + what.string() + " is not a case");
  if (is_volume_file(what) && !std::filesystem::is_directory(what)) {
    const Volume volume = read_volume(what);
    fmt::print("{}\n", common.json
                           ? describe(volume).dump(2, ' ', false, Json::error_handler_t::replace)
                           : what.string() + ": " + line(volume));
    return 0;
  }
  if (!what.empty() && !is_head_name(what.string()) && !std::filesystem::is_directory(what)) {
    const Json mesh = describe(read_mesh(what));
    fmt::print("{}\n", common.json ? mesh.dump(2, ' ', false, Json::error_handler_t::replace)
                                   : what.string() + ": " + line(mesh));
    return 0;
  }
  ProgressBar bar(common);
  if (holds_dicom(what)) {
    const CtFolder folder(what, common.threads, bar.callback());
    bar.clear();
    print_series(folder, what, common);
    return 0;
  }
  const Case patient = open_patient(what, common, bar);
  const Json tissue = options.tissue ? tissue_size(patient, options, common, bar) : Json();
  bar.clear();
  Json json = {{"name", patient.name},
               {"source_units", patient.source.units},
               {"source_frame", patient.source.axes}};
  for (const auto& part : patient.parts) {
    Json described = {{"name", part.name}, {"role", role_name(part.role)}};
    described.update(describe(part.mesh));
    if (!part.teeth.empty()) described["teeth"] = part.teeth.size();
    json["parts"].push_back(described);
  }
  for (int i = 0; i < patient.bodies.size(); ++i)
    json["bodies"].push_back(describe(patient, BodyId{i}));
  for (const auto& [name, point] : patient.landmarks.points)
    json["landmarks"][name] = {point.x(), point.y(), point.z()};
  for (const auto& canal : patient.canals) json["canals"].push_back(describe(patient, canal));
  if (options.tissue) json["tissue"] = tissue;
  json["notes"] = patient.notes;
  if (common.json) {
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
    return 0;
  }
  fmt::print("{} (LPS, mm; imported from {} in {})\n", patient.name, patient.source.axes,
             patient.source.units);
  for (const auto& part : json["parts"])
    fmt::print("  {:<14}{}\n", part["name"].get<std::string>(), line(part));
  for (const auto& canal : patient.canals)
    fmt::print("  canal {}: {:.1f} mm wide, in the {}\n", canal.name, canal.diameter_mm,
               patient.bodies[canal.body].name);
  for (const auto& body : json["bodies"]) fmt::print("  body {}\n", body_line(body));
  fmt::print("  {} landmarks:", patient.landmarks.points.size());
  for (const auto& [name, point] : patient.landmarks.points) fmt::print(" {}", name);
  fmt::print("\n");
  if (options.tissue) fmt::print("{}", tissue_lines(tissue));
  for (const auto& note : patient.notes) fmt::print("  note: {}\n", note);
  return 0;
}

}  // namespace

void add_info(Commands& commands) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App& command = commands.add(
      "info", "Describe a case, a surface file or a scan", "condyle info mycase --json",
      [options](const CommonOptions& common) { return run_info(*options, common); });
  command.add_option(
      "CASE|FILE", options->what,
      "Case folder, surface file, folder of a CT scan (DICOM) or volume (.nrrd, .nhdr, .mha, .mhd, "
      ".nii, .nii.gz; default: the built-in patient)");
  CLI::Option* tissue = command.add_flag(
      "--tissue", options->tissue,
      "Also build the soft tissue of a case, and show its size and its memory for each node");
  in_range(command
               .add_option("--surface-nodes", options->surface_nodes,
                           "Nodes of one layer of the soft tissue, about; default 520")
               ->needs(tissue),
           100, 20000);
}

}  // namespace condyle
