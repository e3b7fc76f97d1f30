#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/dicom/ct_volume.h"
#include "engine/volume/volume_files.h"
#include "sim/case/case_format.h"
#include "sim/case/case_io.h"
#include "sim/case/landmark_files.h"
#include "sim/ct_case/ct_case.h"
#include "sim/phantom/phantom.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/series_list.h"

namespace condyle {
namespace {

struct CtImportOptions {
  std::filesystem::path scan;  // folder or file
  CtRequest request;
  bool list = false;
  std::filesystem::path out, volume_out;
  // Of the case.
  CtCaseRequest make;
  bool no_face = false;
  std::filesystem::path seeds, landmarks;
};

void check_volume_name(const std::filesystem::path& file) {
  if (file.extension() != ".nrrd")
    throw InputError(file, "--volume-out", "must have the extension .nrrd");
}

int list_series(const CtImportOptions& options, const CommonOptions& common) {
  if (!std::filesystem::is_directory(options.scan))
    throw InputError(options.scan, "--list", "is not a folder; condyle info describes a file");
  ProgressBar bar(common);
  const CtFolder folder(options.scan, common.threads, bar.callback());
  bar.clear();
  print_series(folder, options.scan, common);
  return 0;
}

/// Points in the skull and in the lower jaw.
std::vector<SeedPoint> read_seeds(const std::filesystem::path& file) {
  std::vector<SeedPoint> seeds;
  if (file.empty()) return seeds;
  for (const LandmarkRow& row : read_landmark_table(file).rows) {
    if (row.name != "skull" && row.name != "mandible")
      throw InputError(file, row.where,
                       "\"" + row.name.substr(0, 40) +
                           "\" is no bone; a seed is in the skull or in the mandible");
    seeds.push_back({row.point, row.name == "skull" ? skull_label : mandible_label});
  }
  return seeds;
}

nlohmann::ordered_json json_of(const CtCase& made, const CtVolume& ct,
                               const std::filesystem::path& out) {
  nlohmann::ordered_json json = {{"case", out.string()},
                                 {"name", made.patient.name},
                                 {"series", ct.series},
                                 {"threshold_hu", made.threshold_hu}};
  for (const auto& part : made.patient.parts)
    json["parts"].push_back({{"name", part.name},
                             {"role", role_name(part.role)},
                             {"triangles", part.mesh.triangles.size()},
                             {"teeth", part.teeth.size()}});
  for (const auto& one : made.decimation)
    json["decimation"].push_back({{"part", one.part},
                                  {"median_mm", one.median_mm},
                                  {"p95_mm", one.p95_mm},
                                  {"max_mm", one.max_mm}});
  for (const auto& [name, mark] : made.fit.landmarks) {
    nlohmann::ordered_json row = {{"name", name},
                                  {"point", {mark.point.x(), mark.point.y(), mark.point.z()}},
                                  {"uncertainty_mm", mark.uncertainty_mm},
                                  {"doubtful", mark.doubtful},
                                  {"outside_scan", mark.outside_scan}};
    if (!mark.reason.empty()) row["reason"] = mark.reason;
    json["landmarks"].push_back(std::move(row));
  }
  json["notes"] = made.patient.notes;
  return json;
}

int make_case(const CtImportOptions& options, const CtVolume& ct, const CommonOptions& common,
              ProgressBar& bar) {
  CtCaseRequest request = options.make;
  request.face = !options.no_face;
  request.source = options.scan.string();
  request.threads = common.threads;
  request.seeds = read_seeds(options.seeds);
  if (request.name.empty()) request.name = (options.out / "").parent_path().filename().string();
  Landmarks corrected;
  if (!options.landmarks.empty()) corrected = read_landmarks(options.landmarks);
  CtCase made = case_of_ct(ct.volume, builtin_patient(bar.callback()), request, bar.callback());
  for (const auto& [name, point] : corrected.points) made.patient.landmarks.points[name] = point;
  made.patient.notes.insert(made.patient.notes.begin(), ct.notes.begin(), ct.notes.end());
  bar.show("writing", 1);
  save_case(made.patient, options.out);
  bar.clear();
  if (common.json)
    fmt::print("{}\n", json_of(made, ct, options.out)
                           .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (common.prints_summary()) {
    for (const auto& note : made.patient.notes) fmt::print(stderr, "note: {}\n", note);
    const bool moves = made.patient.find(Role::mandible) != nullptr;
    fmt::print(stderr, "{}: {} parts, {} landmarks. Next: condyle {} {}{}\n", options.out.string(),
               made.patient.parts.size(), made.patient.landmarks.points.size(),
               moves ? "record" : "view", options.out.string(),
               moves ? " --motion opening --out out --film" : "");
  }
  return 0;
}

int run_import_ct(const CtImportOptions& options, const CommonOptions& common) {
  if (options.list) return list_series(options, common);
  if (options.out.empty() && options.volume_out.empty())
    throw InputError(
        "import ct needs --out FOLDER for the case, --volume-out FILE.nrrd for the volume, or "
        "--list");
  if (!options.volume_out.empty()) check_volume_name(options.volume_out);
  CtRequest request = options.request;
  request.threads = common.threads;
  ProgressBar bar(common);
  const CtVolume ct = ct_volume(options.scan, request, bar.callback());
  if (!options.volume_out.empty()) {
    bar.show("writing", 0);
    write_nrrd(ct.volume, options.volume_out);
  }
  if (!options.out.empty()) return make_case(options, ct, common, bar);
  bar.clear();
  if (common.prints_summary()) {
    for (const std::string& note : ct.notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}: {} x {} x {} values, {:.3g} x {:.3g} x {:.3g} mm apart\n",
               options.volume_out.string(), ct.volume.size[0], ct.volume.size[1], ct.volume.size[2],
               ct.volume.spacing_mm.x(), ct.volume.spacing_mm.y(), ct.volume.spacing_mm.z());
  }
  return 0;
}

}  // namespace

void add_import_ct(Commands& commands, CLI::App& import) {
  const auto options = std::make_shared<CtImportOptions>();
  CLI::App& command = commands.add_below(
      import, "ct", "From a CT scan: DICOM, NRRD, MetaImage or NIfTI-1",
      "condyle import ct scan --list\n"
      "  condyle import ct scan --out patient\n"
      "  condyle import ct scan --series 2 --volume-out scan.nrrd",
      [options](const CommonOptions& common) { return run_import_ct(*options, common); });
  command
      .add_option("FOLDER|FILE", options->scan,
                  "Folder with DICOM series, or a volume (.nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz)")
      ->required();
  command.add_option("--out", options->out, "Folder of the new case")->type_name("FOLDER");
  command.add_option("--name", options->make.name, "Name of the case; default: that of the folder");
  in_range(command.add_option("--threshold", options->make.threshold_hu,
                              "Least Hounsfield units of bone; default: from the histogram"),
           -500, 3000);
  command
      .add_option("--seeds", options->seeds,
                  "Points that part the jaws (CSV name,x_mm,y_mm,z_mm; the names are skull and "
                  "mandible)")
      ->type_name("FILE");
  command
      .add_option("--landmarks", options->landmarks,
                  "Landmarks that replace the proposed ones (CSV or .mrk.json, as import meshes)")
      ->type_name("FILE");
  command.add_flag("--no-face", options->no_face, "Leave the skin out");
  command.add_flag("--keep-metal-artifacts", options->make.keep_metal_artifacts,
                   "Do not reduce the streaks of metal fillings");
  command.add_flag("--list", options->list, "List the series of the folder, and stop");
  in_range(command.add_option("--series", options->request.series,
                              "The series to read; default: the largest CT with a step of at most "
                              "3 mm"),
           1, 100000);
  command.add_flag("--resample", options->request.resample,
                   "Interpolate slices that are missing or uneven, which are refused otherwise");
  command
      .add_option("--volume-out", options->volume_out,
                  "Write the volume that was read, in Hounsfield units, LPS (.nrrd)")
      ->type_name("FILE");
}

}  // namespace condyle
