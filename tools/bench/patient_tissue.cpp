// Warm frames of a patient's tissue of several sizes, as the window shows and `record` records
// them, beside synthetic sets of equal size.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "sim/contact/contact.h"
#include "sim/motion/motion.h"
#include "sim/muscles/default_face_muscles.h"
#include "sim/muscles/expression_names.h"
#include "sim/simulator/live.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/bench/tissue_warm.h"
#include "tools/common.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;
using FaceVertices = std::vector<Eigen::Vector3f>;

constexpr double degrees_per_frame = 2.0 / 3, last_degrees = 30;
constexpr int sampled_every = 5;
constexpr double most_error_mm = 0.05;

struct FrameGoal {
  int nodes;  // up to
  double median_ms, p95_ms;
};
constexpr FrameGoal frame_goals[] = {
    {3000, 2, 5}, {8000, 8, 20}, {15000, 15, 40}, {1 << 30, 80, 0}};

/// Poses of the jaw along the opening, with equal rotations from one to the next.
std::vector<Pose> steady_opening(const Case& patient) {
  const ContactModel contacts(patient);
  const Motion motion = make_motion("opening", patient, contacts);
  constexpr int parts = 4000;
  std::vector<Pose> poses;
  double reached = 0;
  for (int i = 0; i <= parts && reached < last_degrees; ++i) {
    const Pose X_CM = motion.target(0.5 * motion.duration_s * i / parts);
    const double degrees = rotation_angle(X_CM) * 180 / std::numbers::pi;
    if (degrees < reached + degrees_per_frame) continue;
    reached += degrees_per_frame;
    poses.push_back(X_CM);
  }
  return poses;
}

/// Distances of the vertices that a face has moved from rest by more than 1 mm to where another
/// has them, mm.
void add_errors(const FaceVertices& rest, const FaceVertices& is, const FaceVertices& should,
                std::vector<double>& errors) {
  for (std::size_t i = 0; i < rest.size(); ++i)
    if ((should[i] - rest[i]).norm() > 1) errors.push_back((is[i] - should[i]).norm());
}

/// Muscles of the face and their excitation.
struct FacePull {
  std::vector<FaceMuscle> muscles = {};
  std::vector<double> excitation = {};

  int lines() const {
    std::size_t sum = 0;
    for (std::size_t m = 0; m < excitation.size(); ++m)
      if (excitation[m] > 0) sum += muscles[m].lines.size();
    return static_cast<int>(sum);
  }
};

/// A smile with the lips drawn down and tightened: 40 lines or more.
FacePull pull_of_face(const Case& patient) {
  FacePull pull{.muscles = muscles_of_face(patient)};
  const std::vector<ExpressionLevel> levels{{.name = "open-mouth-smile", .left = 0.5, .right = 0.5},
                                            {.name = "AU13", .left = 0.2, .right = 0.2},
                                            {.name = "AU17", .left = 0.2, .right = 0.2},
                                            {.name = "AU23", .left = 0.2, .right = 0.2}};
  pull.excitation = excitation_of(levels, pull.muscles).muscles;
  return pull;
}

/// How far each frame is solved: to its end, as `record` does, or by the window's budget.
struct FrameRow {
  const char* name;
  TissueBudget budget;
};

/// `pull`: held along the opening; raised from rest before.
Json patient_frames(const Case& patient, const TissueModel& tissue, const std::vector<Pose>& poses,
                    const FrameRow& how, const FacePull& pull = {}) {
  const int threads = how.budget.threads;
  std::vector<double> wall, cpu, iterations, errors;
  FaceVertices rest, is, should;
  TissueState state = rest_tissue(tissue);
  deform_face(tissue, state, rest, threads);
  TissueWarmStart warm;
  constexpr int raising = 15;  // frames
  for (int i = 1; i <= raising && !pull.excitation.empty(); ++i) {
    std::vector<double> part = pull.excitation;
    for (double& of_muscle : part) of_muscle *= static_cast<double>(i) / raising;
    state = solve_tissue(tissue, state, BodyPoses().X_CB, how.budget, warm, part);
  }
  int not_converged = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    BodyPoses at;
    at[patient.jaw.lower_arch] = poses[i];
    const Stopwatch watch;
    state = solve_tissue(tissue, state, at.X_CB, how.budget, warm, pull.excitation);
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
    iterations.push_back(state.iterations);
    not_converged += !state.converged;
    if (i % sampled_every != sampled_every - 1) continue;
    TissueWarmStart aside = warm;
    deform_face(tissue, state, is, threads);
    deform_face(tissue, solve_to_equilibrium(tissue, state, aside, {.threads = threads}), should,
                threads);
    add_errors(rest, is, should, errors);
  }
  if (errors.empty())
    throw InputError(patient.name + ": no vertex of the face moves by more than 1 mm");
  const TissueSummary made = summary(tissue);
  const double error_mm = quantiles(errors).p95;
  Json row = timing_json({how.name, made.nodes, threads, "condyle"}, quantiles(wall),
                         quantiles(cpu).median, error_mm);
  row["patient"] = patient.name;
  row["iterations"] = quantiles(iterations).median;
  row["iterations_p95"] = quantiles(iterations).p95;
  row["frames"] = poses.size();
  row["frames_not_converged"] = not_converged;
  row["greatest_error_mm"] = *std::max_element(errors.begin(), errors.end());
  if (!pull.excitation.empty()) row["lines"] = pull.lines();
  for (const FrameGoal& goal : frame_goals)
    if (made.nodes <= goal.nodes) {
      row["goal"] = goal.median_ms;
      if (goal.p95_ms > 0) row["goal_p95"] = goal.p95_ms;
      break;
    }
  if (error_mm > most_error_mm) row["median"] = row["p95"] = nullptr;
  return row;
}

void print_frames(const Json& row) {
  const auto ms = [&](const char* name) {
    return !row.contains(name) || row[name].is_null()
               ? "-"
               : fmt::format("{:.2f}", row[name].get<double>());
  };
  fmt::print(stderr, "  {:<26}{:>8}{:>10}{:>10}{:>10}{:>8}{:>8}{:>12.1e}\n",
             row["name"].get<std::string>(), row["nodes"].get<int>(), ms("median"), ms("p95"),
             ms("cpu_median"), row["iterations"].get<double>(), ms("goal"),
             row["error_mm"].get<double>());
}

}  // namespace

int run_bench_patient(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  Case patient = open_patient(options.patient, common, bar);
  if (!patient.find(Role::face)) throw InputError(patient.name + " has no face");
  const std::vector<Pose> poses = steady_opening(patient);
  if (poses.size() < sampled_every)
    throw InputError(fmt::format("the jaw of {} opens by less than {:.0f}°", patient.name,
                                 sampled_every * degrees_per_frame));
  part_lips(patient);
  bar.clear();
  if (!common.quiet)
    fmt::print(stderr, "ms  {:<24}{:>8}{:>10}{:>10}{:>10}{:>8}{:>8}{:>12}\n", "", "nodes", "median",
               "p95", "processor", "its", "goal", "error mm");
  Json results = Json::array();
  const auto add = [&](Json row) {
    if (!common.quiet) print_frames(row);
    results.push_back(std::move(row));
  };
  for (const int nodes : options.patient_sizes) {
    TissueSettings settings;
    settings.threads = common.threads;
    settings.surface_nodes = std::max(100, nodes / 4);
    const FacePull pull = pull_of_face(patient);
    settings.face_muscles = pull.muscles;
    const auto tissue = build_tissue(patient, settings);
    const TissueBudget recorded{.threads = common.threads};
    TissueBudget shown = live_settings({}).tissue_budget;
    shown.threads = common.threads;
    const auto both = [&](const FrameRow& relaxed, const char* pulled) {
      add(patient_frames(patient, *tissue, poses, relaxed));
      if (pull.lines() == 0) return;
      const double alone = results.back()["cpu_median"].get<double>();
      Json row = patient_frames(patient, *tissue, poses, {pulled, relaxed.budget}, pull);
      row["over_relaxed"] = row["cpu_median"].get<double>() / alone;
      add(std::move(row));
    };
    both({"patient.tissue", shown}, "patient.muscles");
    both({"patient.recorded", recorded}, "patient.recorded_muscles");
    SyntheticSize size = size_of_nodes(summary(*tissue).nodes);
    size.rim_moves = true;
    add(warm_frames(make_synthetic_set(size), common.threads, "patient.set"));
  }
  if (common.json)
    fmt::print("{}\n", Json{{"machine", machine_json()}, {"results", results}}.dump(
                           2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
