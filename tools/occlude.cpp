#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <system_error>

#include "engine/collide/distance_field.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/user_cache.h"
#include "render/gl/gl_context.h"
#include "render/recording/render_metadata.h"
#include "sim/motion/recording.h"
#include "sim/occlusion/arches.h"
#include "sim/operated/operated_scene.h"
#include "sim/report/occlusion_report.h"
#include "tools/bite_picture.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/motion_options.h"

namespace condyle {
namespace {

struct OccludeOptions {
  std::filesystem::path patient;  // case folder; empty: the built-in patient
  std::filesystem::path plan;     // of an operation before; empty: none
  std::filesystem::path out;
  std::string start;     // pose file or offsets; empty: the pose of the case
  double film_mm = 0.1;  // thickness of the articulating film
};

constexpr const char* picture_name = "arches.png";

struct Start {
  Pose X_CM;
  std::string words;
};

constexpr const char* grid_word = "arches";

/// Two arches without bone and without a scanned bite: no pose of the lower one is known.
bool is_arches_alone(const Case& patient) {
  return !patient.X_CM_bite && std::all_of(patient.parts.begin(), patient.parts.end(),
                                           [](const Part& part) { return is_teeth(part.role); });
}

/// The start as numbers, if the text consists of numbers and commas.
std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  for (const char* at = text.c_str();; ++at) {
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at || (*end != ',' && *end != '\0')) return {};
    at = end;
    if (*at == '\0') return numbers;
  }
}

Start parse_start(const std::string& text, const Case& patient) {
  if (text == grid_word)
    return {normal_relation(find_arches(patient)),
            "a grid about normal incisors: 2 mm sideways, 3 mm forward and back, 2° of turning"};
  if (text.empty() && patient.X_CM_bite)
    return {*patient.X_CM_bite, "the scanned bite of the case"};
  if (text.empty()) return {{}, "the pose of the case"};
  const auto numbers = numbers_in(text);
  if (numbers.empty()) {
    std::error_code none;
    if (!std::filesystem::exists(text, none))
      throw InputError("--start " + text +
                       ": is neither a pose file nor offsets left,back,up[,turns about them] in mm "
                       "and degrees, e.g. 1,-2,0 or 0,0,0,2,0,0");
    return {read_recording(text).target(0), "the first pose of " + text};
  }
  if (numbers.size() != 3 && numbers.size() != 6)
    throw InputError(
        fmt::format("--start {}: has {} numbers; it takes 3 (mm left, back, up) or 6 (and degrees "
                    "about these axes)",
                    text, numbers.size()));
  for (const double number : numbers)
    if (!std::isfinite(number))
      throw InputError("--start " + text + ": every number must be finite");
  const Eigen::Vector3d moved(numbers[0], numbers[1], numbers[2]);
  const Eigen::Vector3d turned = numbers.size() == 6
                                     ? Eigen::Vector3d(numbers[3], numbers[4], numbers[5])
                                     : Eigen::Vector3d::Zero();
  return {displaced_from_rest(patient, moved, turned),
          fmt::format("{} mm left, {} mm back, {} mm up of the case's pose, turned by {}, {} and "
                      "{}° about these axes",
                      moved.x(), moved.y(), moved.z(), turned.x(), turned.y(), turned.z())};
}

std::string bite_line(const Bite& bite) {
  return fmt::format(
      "{}, {} contact{}, {:.0f} % of the load left, overjet {:.1f} mm, overbite "
      "{:.1f} mm",
      bite.stable ? "stable" : "not stable", bite.contacts.size(),
      bite.contacts.size() == 1 ? "" : "s", 100 * bite.left_fraction, bite.after.overjet_mm,
      bite.after.overbite_mm);
}

/// The best bite of a grid of starts; the next ones are listed in the notes.
Bite bite_from_grid(const BiteFinder& finder, const Pose& start, const Progress& progress,
                    std::vector<std::string>& notes) {
  const std::vector<Bite> found = finder.find_from_grid(start, progress);
  Bite best = found.front();
  for (std::size_t i = 1; i < found.size(); ++i) {
    best.others.push_back(found[i].rest);
    const double away_mm =
        (found[i].rest.X_CM * best.upper_edge - best.rest.X_CM * best.upper_edge).norm();
    notes.push_back(fmt::format("bite {} of the grid: {}; {:.1f} mm from the first at the incisors",
                                i + 1, bite_line(found[i]), away_mm));
  }
  return best;
}

/// Name of the picture's file, or empty with a note where drawing is impossible.
std::string write_picture(const std::filesystem::path& folder, const Case& patient,
                          const Bite& bite, double film_mm, int threads,
                          std::vector<std::string>& notes) {
  std::error_code none;
  std::filesystem::remove(folder / picture_name, none);  // of an earlier bite
  try {
    const OffscreenContext context;
    if (const auto lacks = default_render_metadata(context).shortfall(); !lacks.empty())
      notes.push_back(lacks);
    write_png(
        folder / picture_name,
        bite_picture(patient, bite, with_jaw_at(patient.bodies, bite.rest.X_CM), film_mm, threads));
  } catch (const MachineError& error) {
    notes.push_back(fmt::format("the picture is left out: {}", error.what()));
    return "";
  }
  return picture_name;
}

/// The bite before the operation in one sentence.
std::string before_text(const Bite& bite) {
  return "before the operation the bite was " + bite_line(bite);
}

int run_occlude(const OccludeOptions& options, const CommonOptions& common) {
  constexpr int no_stable_bite = 1;
  ProgressBar bar(common);
  const std::optional<Plan> plan = plan_of(options.plan);
  Case patient = open_patient(case_of(options.patient, plan), common, bar);
  std::optional<Bite> before;
  OcclusionSettings settings;
  settings.film_mm = options.film_mm;
  settings.cache = user_cache_folder();
  settings.threads = common.threads;
  if (plan) {
    before = BiteFinder(patient, settings, bar.callback())
                 .find(parse_start(options.start, patient).X_CM, bar.callback());
    patient = operate(patient, *plan).patient;
    patient.X_CM_bite.reset();  // it was scanned before
  }
  const bool grid =
      options.start == grid_word || (options.start.empty() && is_arches_alone(patient));
  if (grid)
    for (const char* condyle : {"left_condyle", "right_condyle"})
      patient.landmarks.points.erase(condyle);  // no joint holds an arch that may lie anywhere
  const Start start = parse_start(grid ? grid_word : options.start, patient);
  OcclusionReport report{patient.name, start.words, settings, {}};
  const BiteFinder finder(patient, settings, bar.callback());
  report.bite = grid ? bite_from_grid(finder, start.X_CM, bar.callback(), report.notes)
                     : finder.find(start.X_CM, bar.callback());
  const Bite& bite = report.bite;
  if (before) report.notes.push_back(before_text(*before));
  if (!options.out.empty()) {
    make_folder(options.out);
    bar.show("drawing", 0.95);
    report.picture =
        write_picture(options.out, patient, bite, options.film_mm, common.threads, report.notes);
    write_file(options.out / "pose.csv", bite_pose_csv(bite));
    write_file(options.out / "motion.csv", bite_motion_csv(bite, start.X_CM));
    write_file(options.out / "report.html", report.page());
    write_file(options.out / "report.json", report.json());
  }
  bar.clear();
  if (common.json) fmt::print("{}", report.json());
  if (common.prints_summary()) {
    for (const auto& note : bite.notes) fmt::print(stderr, "note: {}\n", note);
    for (const auto& note : report.notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}", report.text());
  }
  return bite.stable ? 0 : no_stable_bite;
}

}  // namespace

void add_occlude(Commands& commands) {
  const auto options = std::make_shared<OccludeOptions>();
  CLI::App& command = commands.add(
      "occlude", "Find maximum intercuspation: close the teeth until they rest on each other",
      "condyle occlude mycase --start 1,-2,0 --out out",
      [options](const CommonOptions& common) { return run_occlude(*options, common); });
  command.add_option("CASE", options->patient,
                     "Folder with case.json (default: the built-in patient)");
  add_plan_file(command, options->plan);
  command
      .add_option("--start", options->start,
                  "Where the mandible starts: a pose file, or its displacement from the pose of "
                  "the case in mm to the left, back and up, optionally with rotations about these "
                  "axes in degrees; arches: a grid about normal incisors, of which the best three "
                  "bites are listed; default the scanned bite of the case, else its pose")
      ->type_name("FILE|arches|X,Y,Z[,RX,RY,RZ]");
  in_range(command.add_option("--paper", options->film_mm,
                              "Thickness of the articulating paper, mm; default 0.1"),
           0.02, 0.3);
  command
      .add_option("--out", options->out,
                  "Folder for report.html with its picture, report.json, pose.csv and motion.csv")
      ->type_name("FOLDER");
}

}  // namespace condyle
