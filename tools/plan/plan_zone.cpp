#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/simplify.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/landmark_files.h"
#include "sim/case/source_frame.h"
#include "sim/operation/cut_text.h"
#include "sim/plan/plan_file.h"
#include "tools/common.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Notes = std::vector<std::string>;
using Json = nlohmann::ordered_json;

struct PlanZoneOptions {
  fs::path file;  // of the plan
  std::string name;
  fs::path surface;  // of the zone: a mesh or points
  ZoneKind kind = ZoneKind::other;
  double radius_mm = 0;
  std::optional<double> warn_mm, stop_mm;
  std::string units = "mm", frame = "LPS", patient;
  bool remove = false;
};

const Choices<ZoneKind> zone_kinds_by_name = {{"tooth", ZoneKind::tooth},
                                              {"canal", ZoneKind::canal},
                                              {"foramen", ZoneKind::foramen},
                                              {"other", ZoneKind::other}};

/// A plan holds the zones itself, and each of its history's values does: they are kept small.
constexpr int most_triangles = 6000;

double largest_distance(const TriMesh& from, const TriMesh& to) {
  const TriangleTree tree(to);
  double largest = 0;
  for (const Vector3d& p : from.vertices) largest = std::max(largest, tree.nearest(p).distance);
  return largest;
}

/// To a tenth of a micrometre, so that the numbers in the plan are short.
Vector3d rounded(const Vector3d& p) { return (p * 1e4).array().round() / 1e4; }

void read_surface(const PlanZoneOptions& options, const SourceFrame& source, PlanZone& zone,
                  Notes& notes) {
  TriMesh mesh = read_mesh(options.surface);
  const Eigen::Matrix3d to_lps = source.to_lps_mm();
  for (Vector3d& p : mesh.vertices) p = to_lps * p;
  if (source.mirrored()) flip(mesh);
  weld(mesh);
  drop_degenerate(mesh);
  drop_duplicates(mesh);
  drop_unreferenced(mesh);
  if (mesh.triangles.empty()) throw InputError(options.surface, "", "has no triangle with an area");
  orient_outward(mesh);
  if (static_cast<int>(mesh.triangles.size()) > most_triangles) {
    const TriMesh full = mesh;
    mesh = simplify(full, most_triangles);
    drop_unreferenced(mesh);
    notes.push_back(
        fmt::format("the surface of {} triangles is stored with {}, at most {:.2f} mm from it",
                    full.triangles.size(), mesh.triangles.size(),
                    std::max(largest_distance(full, mesh), largest_distance(mesh, full))));
  }
  if (mesh.triangles.size() > max_zone_triangles || mesh.vertices.size() > max_zone_points)
    throw InputError(options.surface, "",
                     fmt::format("has {} triangles, and cannot be simplified to less than {}",
                                 mesh.triangles.size(), max_zone_triangles));
  for (const Vector3d& p : mesh.vertices) zone.points.push_back(rounded(p));
  zone.triangles = mesh.triangles;
  if (!inspect(mesh).closed())
    notes.push_back(
        "the surface is open: a cut that lies wholly behind it counts by its distance "
        "from the surface");
}

void read_line(const PlanZoneOptions& options, const SourceFrame& source, PlanZone& zone) {
  const LandmarkTable table = read_point_table(options.surface);
  const Eigen::Matrix3d to_lps = source.to_lps_mm();
  if (table.rows.size() > max_zone_points)
    throw InputError(options.surface, "",
                     fmt::format("has {} points; at most {}", table.rows.size(), max_zone_points));
  for (const LandmarkRow& row : table.rows)
    zone.points.push_back(rounded(table.own_frame ? row.point : Vector3d(to_lps * row.point)));
}

/// Refuses a zone far from the patient: of other units or axes.
void check_place(const PlanZone& zone, const Plan& plan, const fs::path& file) {
  constexpr double beyond_mm = 200;
  Box patient;
  for (const auto& [name, p] : plan.geometry.landmarks.points) patient.add(p);
  if (patient.empty()) return;
  double farthest = 0;
  for (const Vector3d& p : zone.points) {
    const Vector3d apart = (p - patient.high).cwiseMax(patient.low - p).cwiseMax(Vector3d::Zero());
    farthest = std::max(farthest, apart.norm());
  }
  if (farthest > beyond_mm)
    throw InputError(file, "",
                     fmt::format("reaches {:.0f} mm beyond the patient's landmarks: check --units "
                                 "and --frame (mm and LPS are expected)",
                                 farthest));
}

PlanZone read_zone(const PlanZoneOptions& options, const Plan& plan, Notes& notes) {
  PlanZone zone{.name = options.name,
                .kind = options.kind,
                .radius_mm = options.radius_mm,
                .warn_mm = options.warn_mm,
                .stop_mm = options.stop_mm};
  const SourceFrame source = source_frame(options.units, options.frame);
  std::string extension = options.surface.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".csv" || extension == ".json" || extension == ".txt" || extension == ".tsv")
    read_line(options, source, zone);
  else
    read_surface(options, source, zone, notes);
  check_place(zone, plan, options.surface);
  return zone;
}

/// What the cuts of the plan do to the zone.
Notes findings_of(const Plan& plan, const PlanZoneOptions& options, const CommonOptions& common) {
  const bool cuts = std::any_of(plan.steps.begin(), plan.steps.end(), [](const PlanStep& step) {
    return std::holds_alternative<CutStep>(step.action);
  });
  if (!cuts) return {};
  const auto patient = case_of_plan(options.patient, plan, common);
  if (!patient) return {"the plan's cuts are not checked: give the case with --case"};
  Notes notes;
  for (const CutReport& cut : apply_plan(*patient, plan).cuts)
    for (const DangerFinding& finding : cut.dangers)
      if (finding.zone == options.name)
        notes.push_back(fmt::format("step {} ({}): {}", cut.step, cut.title, danger_text(finding)));
  if (notes.empty()) notes.push_back("no cut of the plan comes within 15 mm of it");
  return notes;
}

int run_plan_zone(const PlanZoneOptions& options, const CommonOptions& common) {
  Plan plan = load_plan(options.file);
  if (options.name.empty()) {
    if (common.json) {
      Json zones = Json::parse(plan_json(plan)).value("zones", Json::array());
      fmt::print("{}\n", zones.dump(1));
    } else {
      fmt::print("{}",
                 plan.zones.empty() ? "the plan has no zones of its own\n" : zones_text(plan));
    }
    return 0;
  }
  if (options.remove) {
    if (!options.surface.empty())
      throw InputError("--remove takes the name of the zone alone, not a file");
    finish_edit(without_zone(std::move(plan), options.name), options.file,
                "remove zone " + options.name, common);
    return 0;
  }
  if (options.surface.empty())
    throw InputError("zone \"" + options.name +
                     "\" needs the file of its surface or points, or --remove");
  Notes notes;
  plan = with_zone(plan, read_zone(options, plan, notes));
  const Notes findings = findings_of(plan, options, common);
  notes.insert(notes.end(), findings.begin(), findings.end());
  finish_edit(plan, options.file, "zone " + options.name, common);
  print_plan_notes(common, notes);
  return 0;
}

}  // namespace

void add_plan_zone(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanZoneOptions>();
  CLI::App& command = commands.add_below(
      plan, "zone", "Add a danger zone of your own, list them, or remove one",
      "condyle plan zone plan.json tumour tumour.stl --stop 10\n"
      "  condyle plan zone plan.json artery artery.csv --radius 1.5 --kind canal\n"
      "  condyle plan zone plan.json",
      [options](const CommonOptions& common) { return run_plan_zone(*options, common); });
  add_plan_argument(command, options->file);
  command.add_option("NAME", options->name, "Name of the zone; without it, all are listed");
  command.add_option("FILE", options->surface,
                     "Its surface (PLY, STL, OBJ, GLB), or a line of points (CSV with x_mm, y_mm, "
                     "z_mm, or .mrk.json)");
  command
      .add_option_function<std::string>(
          "--kind",
          [options](const std::string& word) {
            options->kind = chosen(zone_kinds_by_name, "--kind", word);
          },
          "What it is, which decides the default margins; default other")
      ->type_name(words_of(zone_kinds_by_name));
  in_range(
      command.add_option("--radius", options->radius_mm, "Radius around the line or surface, mm"),
      0, max_zone_radius_mm);
  in_range(
      command.add_option("--warn", options->warn_mm, "Cuts nearer than this are warned of, mm"), 0,
      max_zone_margin_mm);
  in_range(command.add_option("--stop", options->stop_mm, "Cuts nearer than this are refused, mm"),
           0, max_zone_margin_mm);
  command.add_option("--units", options->units, "Unit of FILE; default mm")
      ->type_name("mm|cm|m|in");
  command.add_option("--frame", options->frame, "Axes of FILE: LPS (the default), RAS, ...")
      ->type_name("AXES");
  command.add_flag("--remove", options->remove, "Remove the zone of this name");
  add_plan_case(command, options->patient, "the built-in head that the plan names");
}

}  // namespace condyle
