#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "sim/case/case_io.h"
#include "sim/case/source_frame.h"
#include "sim/dental_scan/scanned_arches.h"
#include "sim/phantom/phantom.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/residual_map.h"

namespace condyle {
namespace {

struct TeethImportOptions {
  std::filesystem::path patient;  // case folder; empty: the scans alone
  std::filesystem::path upper, lower, upper_points, lower_points;
  std::string units = "mm", name;
  bool accept = false;
  std::filesystem::path residuals;
  std::filesystem::path out;
};

nlohmann::ordered_json pose_json(const Pose& X) {
  return {{"rotation", {X.R.w(), X.R.x(), X.R.y(), X.R.z()}},
          {"translation_mm", {X.t.x(), X.t.y(), X.t.z()}}};
}

/// Of the vertices of a scan that have a partner.
nlohmann::ordered_json residuals_json(const std::vector<float>& residual_mm) {
  std::vector<float> found;
  for (const float residual : residual_mm)
    if (!std::isnan(residual)) found.push_back(residual);
  nlohmann::ordered_json json = {{"vertices", residual_mm.size()}, {"with_partner", found.size()}};
  if (found.empty()) return json;
  std::sort(found.begin(), found.end());
  json["least_mm"] = found.front();
  json["median_mm"] = found[found.size() / 2];
  json["largest_mm"] = found.back();
  return json;
}

nlohmann::ordered_json fit_json(const ArchFit& fit, const std::vector<TrimmedBone>& bones) {
  nlohmann::ordered_json json = {{"mean_mm", fit.mean_mm},     {"median_mm", fit.median_mm},
                                 {"p95_mm", fit.p95_mm},       {"left_out", fit.left_out},
                                 {"halves_mm", fit.halves_mm}, {"points", fit.points},
                                 {"X_CS", pose_json(fit.X_CS)}};
  if (fit.mirrored_mm) json["mirrored_mm"] = *fit.mirrored_mm;
  if (fit.exchanged_mm) json["exchanged_mm"] = *fit.exchanged_mm;
  if (!fit.residual_mm.empty()) json["residuals"] = residuals_json(fit.residual_mm);
  json["bones"] = nlohmann::ordered_json::array();
  for (const auto& bone : bones)
    json["bones"].push_back(
        {{"part", bone.part}, {"removed_mm3", bone.removed_mm3}, {"open_edges", bone.open_edges}});
  return json;
}

nlohmann::ordered_json result_json(const ScannedArches& made, const std::filesystem::path& out) {
  nlohmann::ordered_json json = {{"case", out.string()}, {"name", made.patient.name}};
  if (made.upper) json["upper"] = fit_json(*made.upper, made.upper_bones);
  if (made.lower) json["lower"] = fit_json(*made.lower, made.lower_bones);
  if (made.together)
    json["in_occlusion"] = {{"found", made.together->in_occlusion},
                            {"left_places", made.together->left},
                            {"right_places", made.together->right}};
  if (made.bite)
    json["bite"] = {{"largest_mm", made.bite->largest_mm},
                    {"rotation_deg", made.bite->rotation_deg},
                    {"X_CM", pose_json(made.bite->X_CM)}};
  for (const auto& part : made.patient.parts)
    json["parts"].push_back({{"name", part.name},
                             {"role", role_name(part.role)},
                             {"triangles", part.mesh.triangles.size()},
                             {"teeth", part.teeth.size()}});
  json["notes"] = made.patient.notes;
  return json;
}

ScannedArchesRequest request_of(const TeethImportOptions& options, int threads) {
  ScannedArchesRequest request;
  const double mm = unit_mm(options.units);
  const auto take = [&](const std::filesystem::path& file, const std::filesystem::path& points,
                        const char* option, std::optional<DentalScan>& scan, Landmarks& picks) {
    if (file.empty() && !points.empty())
      throw InputError(fmt::format("--{}-points needs --{} FILE", option, option));
    if (file.empty()) return;
    scan = read_dental_scan(file, mm, !points.empty());
    if (points.empty()) return;
    picks = read_landmarks(points);
    for (auto& [name, p] : picks.points) p *= mm;
  };
  take(options.upper, options.upper_points, "upper", request.upper, request.upper_picks);
  take(options.lower, options.lower_points, "lower", request.lower, request.lower_picks);
  request.accept_residual = options.accept;
  request.threads = threads;
  return request;
}

/// Both arches in one file, where they lie in the case.
void write_residuals(const ScannedArchesRequest& request, const ScannedArches& made,
                     const std::filesystem::path& file) {
  ResidualMap map(refused_fit_mm);
  if (made.upper) map.add(request.upper->mesh, made.upper->X_CS, made.upper->residual_mm);
  if (made.lower) map.add(request.lower->mesh, made.lower->X_CS, made.lower->residual_mm);
  map.write(file);
}

int run_import_teeth(const TeethImportOptions& options, const CommonOptions& common) {
  if (options.upper.empty() && options.lower.empty())
    throw InputError("no dental scan is given; name one with --upper or --lower");
  if (options.patient.empty() && !options.residuals.empty())
    throw InputError("--residuals needs CASE, to whose crowns the scans are registered");
  check_residual_file(options.residuals, {options.patient, options.out},
                      {options.upper, options.lower, options.upper_points, options.lower_points});
  ProgressBar bar(common);
  bar.show("reading", 0);
  const ScannedArchesRequest request = request_of(options, common.threads);
  ScannedArches made =
      options.patient.empty()
          ? case_of_scanned_arches(request, builtin_patient(bar.callback()), bar.callback())
          : with_scanned_arches(open_patient(options.patient, common, bar), request,
                                bar.callback());
  if (!options.name.empty())
    made.patient.name = options.name;
  else if (options.patient.empty())
    made.patient.name = (options.out / "").parent_path().filename().string();
  bar.show("writing", 1);
  save_case(made.patient, options.out);
  if (!options.residuals.empty()) write_residuals(request, made, options.residuals);
  bar.clear();
  if (common.json)
    fmt::print("{}\n", result_json(made, options.out)
                           .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (common.prints_summary()) {
    for (const auto& note : made.notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}: {} parts. Next: condyle occlude {} --out out\n", options.out.string(),
               made.patient.parts.size(), options.out.string());
  }
  return 0;
}

}  // namespace

void add_import_teeth(Commands& commands, CLI::App& import) {
  const auto options = std::make_shared<TeethImportOptions>();
  CLI::App& command = commands.add_below(
      import, "teeth", "From scans of the dental arches: STL, PLY, OBJ or GLB",
      "condyle import teeth patient --upper upper.stl --lower lower.stl --out patient-teeth\n"
      "  condyle import teeth --upper upper.stl --lower lower.stl --out arches",
      [options](const CommonOptions& common) { return run_import_teeth(*options, common); });
  command.add_option("CASE", options->patient,
                     "Case whose crowns the scans replace; without one, the scans alone make a "
                     "case");
  command.add_option("--upper", options->upper, "Scan of the upper arch")->type_name("FILE");
  command.add_option("--lower", options->lower, "Scan of the lower arch")->type_name("FILE");
  command
      .add_option("--upper-points", options->upper_points,
                  "Points picked on the upper scan, in its frame, with the names of landmarks of "
                  "the case (three or more; CSV or .mrk.json)")
      ->type_name("FILE");
  command.add_option("--lower-points", options->lower_points, "The same on the lower scan")
      ->type_name("FILE");
  command.add_option("--units", options->units, "Unit of the files; default mm")
      ->type_name("mm|cm|m|in");
  command.add_flag("--accept", options->accept,
                   "Accept a scan that lies more than 0.5 mm off after registration");
  command
      .add_option(
          "--residuals", options->residuals,
          "Write the registered scans coloured by their distance to the case's crowns: blue "
          "0.5 mm inside, red 0.5 mm outside; with the distances (.ply)")
      ->type_name("FILE");
  command.add_option("--name", options->name, "Name of the case")->type_name("TEXT");
  command.add_option("--out", options->out, "Folder of the new case")
      ->type_name("FOLDER")
      ->required();
}

}  // namespace condyle
