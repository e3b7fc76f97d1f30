#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/mesh_files.h"
#include "render/gl/gl_context.h"
#include "render/image/image.h"
#include "render/plan/face_pictures.h"
#include "sim/case/landmark_files.h"
#include "sim/plan/plan_file.h"
#include "sim/prediction/predicted_landmarks.h"
#include "sim/prediction/prediction.h"
#include "sim/prediction/soft_ratios.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

struct PredictOptions {
  std::filesystem::path patient, plan, out;
  int surface_nodes = 520;
};

void draw_pictures(const Prediction& prediction, const std::filesystem::path& folder) {
  const OffscreenContext context;
  for (const FacePicture& picture : face_pictures(prediction))
    write_png(folder / fmt::format("{}_{}.png", picture.what, picture.view), picture.image);
}

TriMesh face_at(const Prediction& prediction, const std::vector<Eigen::Vector3f>& vertices) {
  TriMesh mesh = prediction.face;
  for (std::size_t i = 0; i < vertices.size(); ++i) mesh.vertices[i] = vertices[i].cast<double>();
  return mesh;
}

int run_predict(const PredictOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Plan plan = load_plan(options.plan);
  const Case patient = open_patient(case_of(options.patient, plan), common, bar);
  PredictionSettings settings;
  settings.threads = common.threads;
  settings.tissue.surface_nodes = options.surface_nodes;
  const ClinicalFrame frame = clinical_frame(patient.landmarks, plan.reference);
  const Prediction prediction = predict(patient, plan, settings, bar.callback());
  std::vector<std::string> notes = prediction.operated.notes;
  if (!options.out.empty()) {
    make_folder(options.out);
    write_ply(face_at(prediction, prediction.before), options.out / "face_before.ply");
    write_ply(face_at(prediction, prediction.after), options.out / "face_after.ply");
    write_file(options.out / "landmarks_after.csv", landmarks_csv(predicted_landmarks(prediction)));
    bar.show("drawing", 0.95);
    try {
      draw_pictures(prediction, options.out);
    } catch (const MachineError& error) {
      notes.push_back(fmt::format("pictures are left out: {}", error.what()));
    }
    write_file(options.out / "report.json", prediction_json(prediction, frame).dump(2) + "\n");
  }
  bar.clear();
  if (common.json) fmt::print("{}\n", prediction_json(prediction, frame).dump(2));
  if (common.prints_summary()) {
    for (const auto& note : notes) fmt::print(stderr, "note: {}\n", note);
    for (const auto& problem : prediction.operated.problems)
      fmt::print(stderr, "warning: {}\n", problem);
    fmt::print(stderr, "{}", prediction_text(prediction, frame));
  }
  return 0;
}

}  // namespace

void add_predict(Commands& commands) {
  const auto options = std::make_shared<PredictOptions>();
  CLI::App& command = commands.add(
      "predict", "Predict the face after the operation of a plan",
      "condyle predict mycase --plan plan.json --out out",
      [options](const CommonOptions& common) { return run_predict(*options, common); });
  command.add_option("CASE", options->patient,
                     "Folder with case.json (default: the built-in patient)");
  command.add_option("--plan", options->plan, "Plan file, see condyle plan")
      ->required()
      ->type_name("FILE");
  in_range(command.add_option("--surface-nodes", options->surface_nodes,
                              "Nodes of one layer, about; default 520"),
           200, 32000);
  command
      .add_option("--out", options->out,
                  "Folder for pictures before and after, a map of the displacement, "
                  "face_before.ply, face_after.ply, landmarks_after.csv and report.json")
      ->type_name("FOLDER");
}

}  // namespace condyle
