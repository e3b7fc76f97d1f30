#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.h"
#include "sim/case/case_format.h"
#include "sim/case/case_io.h"
#include "sim/case/soft_landmarks.h"
#include "sim/face_scan/fuse_face.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/residual_map.h"

namespace condyle {
namespace {

constexpr double full_residual_mm = 2;  // of the strongest colours

struct FaceImportOptions {
  std::filesystem::path scan, patient, landmarks, residuals, out;
  std::string units = "mm", frame = "LPS", name;
};

nlohmann::ordered_json json_of(const FaceRegistration& found, const FaceFusion& fusion) {
  nlohmann::ordered_json json = {
      {"median_mm", found.median_mm},
      {"p95_mm", found.p95_mm},
      {"covered", found.covered},
      {"rotation", {found.X_CS.R.w(), found.X_CS.R.x(), found.X_CS.R.y(), found.X_CS.R.z()}},
      {"translation_mm", {found.X_CS.t.x(), found.X_CS.t.y(), found.X_CS.t.z()}},
      {"skin_covered", fusion.covered},
      {"skin_moved_mm", fusion.moved_mm}};
  if (found.fiducial_rms_mm) json["fiducial_rms_mm"] = *found.fiducial_rms_mm;
  if (found.target_rms_mm) json["target_rms_mm"] = *found.target_rms_mm;
  if (found.mouth_opening_mm) json["mouth_opening_mm"] = *found.mouth_opening_mm;
  for (const auto& one : found.landmarks)
    json["landmarks"].push_back(
        {{"name", one.name}, {"fiducial_mm", one.fiducial_mm}, {"target_mm", one.target_mm}});
  return json;
}

std::vector<std::string> notes_of(const FaceRegistration& found, const FaceFusion& fusion) {
  std::vector<std::string> notes = {
      fmt::format("face scan: registered to the skin above the mouth to {:.2f} mm (median), {:.2f} "
                  "mm (95 %); {:.0f} % of it lies on the skin",
                  found.median_mm, found.p95_mm, 100 * found.covered)};
  if (found.fiducial_rms_mm)
    notes.push_back(
        fmt::format("face scan: {} landmarks, fiducial registration error {:.2f} mm, "
                    "target registration error {:.2f} mm (rms)",
                    found.landmarks.size(), *found.fiducial_rms_mm, *found.target_rms_mm));
  notes.push_back(
      fmt::format("face: {:.0f} % of the skin taken from the scan, moved by {:.2f} mm "
                  "(median)",
                  100 * fusion.covered, fusion.moved_mm));
  return notes;
}

/// A patient of the face alone.
Case face_case(FaceScan scan, const Landmarks& landmarks) {
  Case patient;
  patient.parts.push_back({"face", Role::face, std::move(scan.mesh), {}});
  patient.landmarks = landmarks;
  estimate_profile_landmarks(patient);
  return patient;
}

int run_import_face(const FaceImportOptions& options, const CommonOptions& common) {
  check_residual_file(options.residuals, {options.patient, options.out},
                      {options.scan, options.landmarks});
  ProgressBar bar(common);
  bar.show("reading the scan", 0);
  const SourceFrame frame = source_frame(options.units, options.frame);
  FaceScan scan = read_face_scan(options.scan, frame);
  Landmarks landmarks;
  if (!options.landmarks.empty()) landmarks = read_landmarks(options.landmarks);
  for (auto& [name, p] : landmarks.points) p = frame.axes_to_lps * p;
  std::vector<std::string> notes = scan.notes;
  nlohmann::ordered_json json = {{"case", options.out.string()}};
  Case patient;
  std::optional<ResidualMap> map;
  if (options.patient.empty()) {
    if (!options.residuals.empty())
      throw InputError("--residuals needs --case, to whose skin the scan is registered");
    patient = face_case(std::move(scan), landmarks);
  } else {
    patient = load_case(options.patient);
    bar.show("registering", 0.3);
    const FaceRegistration found =
        register_face(scan, landmarks, patient, options.scan.string(), common.threads);
    bar.show("moving the skin", 0.7);
    const FaceFusion fusion = fuse_face(scan, found, common.threads, patient);
    for (const auto& note : notes_of(found, fusion)) notes.push_back(note);
    notes.insert(notes.end(), found.notes.begin(), found.notes.end());
    if (!options.residuals.empty())
      map.emplace(full_residual_mm).add(scan.mesh, found.X_CS, found.residual_mm);
    json["registration"] = json_of(found, fusion);
  }
  if (!options.name.empty() || patient.name.empty())
    patient.name =
        options.name.empty() ? (options.out / "").parent_path().filename().string() : options.name;
  patient.notes.insert(patient.notes.end(), notes.begin(), notes.end());
  bar.show("writing", 0.95);
  save_case(patient, options.out);
  if (map) map->write(options.residuals);
  bar.clear();
  json["notes"] = notes;
  if (common.json)
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (common.prints_summary()) {
    for (const auto& note : notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}: {} parts. Next: condyle view {}\n", options.out.string(),
               patient.parts.size(), options.out.string());
  }
  return 0;
}

}  // namespace

void add_import_face(Commands& commands, CLI::App& import) {
  const auto options = std::make_shared<FaceImportOptions>();
  CLI::App& command = commands.add_below(
      import, "face", "From a scanned face: a depth map with colours, or a textured surface",
      "condyle import face laser.json --case patient --landmarks marks.csv --out with-face\n"
      "  condyle import face scan.obj --units m --out face",
      [options](const CommonOptions& common) { return run_import_face(*options, common); });
  command
      .add_option("FILE", options->scan,
                  "Description of a depth map (.json), or a surface (.ply, .stl, .obj, .glb)")
      ->required();
  command.add_option("--out", options->out, "Folder of the new case")
      ->type_name("FOLDER")
      ->required();
  command
      .add_option("--case", options->patient,
                  "Case to whose skin the scan is registered; default: the face becomes a case of "
                  "its own")
      ->type_name("FOLDER");
  command.add_option("--name", options->name, "Name of the new case")->type_name("TEXT");
  command
      .add_option("--landmarks", options->landmarks,
                  "Landmarks on the scan, in its coordinates in mm (CSV or .mrk.json); three and "
                  "more start the registration")
      ->type_name("FILE");
  command.add_option("--units", options->units, "Unit of a surface's file; default mm")
      ->type_name("mm|cm|m|in");
  command.add_option("--frame", options->frame, "Axes of the file: LPS (the default), RAS, ...")
      ->type_name("AXES");
  command
      .add_option("--residuals", options->residuals,
                  "Write the registered scan coloured by its distance to the skin: blue 2 mm "
                  "inside, red 2 mm outside; with the distances (.ply)")
      ->type_name("FILE");
}

}  // namespace condyle
