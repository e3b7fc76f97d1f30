#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "tools/common.h"

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

}  // namespace

int run_info(const std::filesystem::path& what, const CommonOptions& common) {
  if (!what.empty() && !std::filesystem::is_directory(what)) {
    const Json mesh = describe(read_mesh(what));
    fmt::print("{}\n", common.json ? mesh.dump(2, ' ', false, Json::error_handler_t::replace)
                                   : what.string() + ": " + line(mesh));
    return 0;
  }
  ProgressBar bar(common);
  const Case patient = open_patient(what, common, bar);
  bar.clear();
  Json json = {{"name", patient.name},
               {"source_units", patient.source_units},
               {"source_frame", patient.source_frame}};
  for (const auto& part : patient.parts) {
    Json described = {{"name", part.name}, {"role", role_name(part.role)}};
    described.update(describe(part.mesh));
    if (!part.teeth.empty()) described["teeth"] = part.teeth.size();
    json["parts"].push_back(described);
  }
  for (const auto& [name, point] : patient.landmarks.points)
    json["landmarks"][name] = {point.x(), point.y(), point.z()};
  json["notes"] = patient.notes;
  if (common.json) {
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
    return 0;
  }
  fmt::print("{} (LPS, mm; imported from {} in {})\n", patient.name, patient.source_frame,
             patient.source_units);
  for (const auto& part : json["parts"])
    fmt::print("  {:<14}{}\n", part["name"].get<std::string>(), line(part));
  fmt::print("  {} landmarks:", patient.landmarks.points.size());
  for (const auto& [name, point] : patient.landmarks.points) fmt::print(" {}", name);
  fmt::print("\n");
  for (const auto& note : patient.notes) fmt::print("  note: {}\n", note);
  return 0;
}

}  // namespace condyle
