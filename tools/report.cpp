#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "engine/collide/distance_field.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/user_cache.h"
#include "render/gl/gl_context.h"
#include "render/image/image.h"
#include "render/plan/face_pictures.h"
#include "render/plan/segment_pictures.h"
#include "sim/operated/operated_scene.h"
#include "sim/operation_page/operation_page.h"
#include "sim/phantom/cache.h"
#include "sim/plan/plan_file.h"
#include "tools/bite_picture.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/motion_options.h"
#include "tools/plan/graft_report.h"

namespace condyle {
namespace {

struct ReportOptions {
  std::filesystem::path patient, plan, out;
  std::string title = {};
  std::string motion = "open; close; protrude 8; close; left 8; close; right 8; close";
  bool predicts = true, moves = true, measures_clearance = false, shows_notes = false;
};

struct MovedSide {
  Scene scene;
  Motion motion;
  ClearanceCheck check;
};

/// The jaw's movements before and after, of bones alone.
OperationComparison compared_motion(const ReportOptions& options, const Case& patient,
                                    const Plan& plan, const CommonOptions& common,
                                    const Progress& progress) {
  constexpr double fps = 15;
  SimulatorSettings settings;
  settings.threads = common.threads;
  settings.tissue = false;
  settings.step_s = 1.0 / 60;
  const auto side = [&](const std::optional<Plan>& operation) {
    Scene scene = make_scene(patient, operation, settings, progress);
    Motion motion = make_motion(options.motion, scene.patient, scene.contacts);
    ClearanceCheck check;
    if (options.measures_clearance)
      check = check_clearance(scene, motion, {.sampling = {.fps = fps}}, settings, progress);
    else
      for (int i = 0; i / fps <= motion.duration_s; ++i) check.time_s.push_back(i / fps);
    return MovedSide{std::move(scene), std::move(motion), std::move(check)};
  };
  const MovedSide before = side(std::nullopt), after = side(plan);
  return compare_operation(before.scene, before.motion, before.check, after.scene, after.motion,
                           after.check);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (const auto start = line.find_first_not_of(' '); start != std::string::npos)
      lines.push_back(line.substr(start));
  return lines;
}

void draw_pictures(OperationPage& page) {
  const OffscreenContext context;
  page.bones.push_back({encode_png(segment_sheet(page.operated, {.title = ""})),
                        "The bones before the operation (above) and after it (below), with the "
                        "segments in colours."});
  if (page.prediction)
    page.face.push_back({encode_png(face_sheet(face_pictures(*page.prediction), "")),
                         "The face before and after the operation, and the map of its "
                         "displacement."});
}

/// The bite that the planned positions close into; none without teeth in both arches.
std::optional<Bite> planned_bite(const Case& after, const CommonOptions& common,
                                 const Progress& progress) {
  if (!after.has_both_arches()) return std::nullopt;
  OcclusionSettings settings;
  settings.threads = common.threads;
  settings.cache = user_cache_folder();
  return BiteFinder(after, settings, progress).find({}, progress);
}

int run_report(const ReportOptions& options, const CommonOptions& common) {
  if (options.out.has_extension() && options.out.extension() != ".html" &&
      options.out.extension() != ".htm")
    throw InputError("--out " + options.out.string() + ": the page is an HTML file: name it .html");
  if (options.moves) check_motion(options.motion);
  if (const auto folder = options.out.parent_path(); !folder.empty()) make_folder(folder);
  ProgressBar bar(common);
  const Plan plan = load_plan(options.plan);
  const Case patient = open_patient(case_of(options.patient, plan), common, bar);
  std::vector<std::string> remarks;
  std::optional<Prediction> prediction;
  PredictionSettings settings;
  settings.threads = common.threads;
  if (options.predicts && patient.find(Role::face))
    prediction = predict(patient, plan, settings, bar.callback());
  else
    remarks.push_back(options.predicts ? "the case has no face: it is not predicted"
                                       : "the face was not predicted, on request");
  const Operated operated = prediction ? prediction->operated : apply_plan(patient, plan);
  if (!operated.problems.empty())
    throw InputError(options.plan.string() + ": " +
                     fmt::format("{}", fmt::join(operated.problems, "; ")));
  std::optional<OperationComparison> motion;
  if (options.moves) motion = compared_motion(options, patient, plan, common, bar.callback());
  const Case after = operated_case(operated);
  const std::optional<Bite> bite = planned_bite(after, common, bar.callback());

  OperationPage page{.plan = plan,
                     .operated = operated,
                     .prediction = prediction ? &*prediction : nullptr,
                     .motion = motion ? &*motion : nullptr,
                     .bite = bite ? &*bite : nullptr,
                     .title = options.title,
                     .program = "Condyle " CONDYLE_VERSION,
                     .date = fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr))),
                     .case_hash = geometry_hash(geometry_of(patient)),
                     .plan_hash = plan_hash(plan),
                     .graft_lines = lines_of(graft_report_text(plan, operated)),
                     .shows_notes = options.shows_notes,
                     .remarks = remarks};
  bar.show("drawing", 0.95);
  try {
    draw_pictures(page);
  } catch (const MachineError& error) {
    page.remarks.push_back(fmt::format("pictures are left out: {}", error.what()));
  }
  const std::string html = operation_page(page);
  write_file(options.out, html);
  bar.clear();
  if (common.json)
    fmt::print("{}\n", nlohmann::ordered_json{{"file", options.out.string()},
                                              {"bytes", html.size()},
                                              {"case_hash", page.case_hash},
                                              {"plan_hash", page.plan_hash}}
                           .dump(2));
  if (common.prints_summary()) {
    for (const auto& remark : page.remarks) fmt::print(stderr, "note: {}\n", remark);
    fmt::print(stderr, "the page is {}, {:.1f} MB\n", options.out.string(),
               static_cast<double>(html.size()) / 1e6);
  }
  return 0;
}

}  // namespace

void add_report(Commands& commands) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App& command =
      commands.add("report", "Write a plan as one page for people, to open offline or print",
                   "condyle report mycase --plan plan.json --out plan.html",
                   [options](const CommonOptions& common) { return run_report(*options, common); });
  command.add_option("CASE", options->patient,
                     "Folder with case.json (default: the built-in head of the plan)");
  command.add_option("--plan", options->plan, "Plan file, see condyle plan")
      ->required()
      ->type_name("FILE");
  command.add_option("--out", options->out, "The page; its folder is made")
      ->required()
      ->type_name("FILE.html");
  command
      .add_option(
          "--title", options->title,
          "Heading of the page; default: the osteotomies. No name of a patient should be in it")
      ->type_name("TEXT");
  command
      .add_option(
          "--motion", options->motion,
          "Movements that are compared before and after the operation; default " + options->motion)
      ->type_name("MOTION");
  command.add_flag("--clearances", options->measures_clearance,
                   "Also measure the least distances of bones and teeth in these movements, which "
                   "takes minutes");
  command.add_flag_callback(
      "--no-motion", [options] { options->moves = false; }, "Leave out the range of motion");
  command.add_flag_callback(
      "--no-prediction", [options] { options->predicts = false; }, "Leave out the face");
  command.add_flag("--notes", options->shows_notes,
                   "Show the notes of the plan, which may name a person");
}

}  // namespace condyle
