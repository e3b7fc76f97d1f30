// Planning: cuts previewed, plans applied, faces predicted.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "engine/cut/cut.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/phantom/phantom.h"
#include "sim/prediction/predictor.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/common.h"
#include "tools/demo/class_iii_plan.h"
#include "tools/demo/plan_steps.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

/// An operation, and the same with one segment 0.5 mm farther.
struct BenchOperation {
  std::string name;
  const Case* patient;
  Plan plan, changed;
};

struct MeasuredTimes {
  std::vector<double> wall, cpu;
  void add(const Stopwatch& watch) {
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
  }
};

class PredictBench {
 public:
  PredictBench(const BenchOptions& options, const CommonOptions& common)
      : options_(options), common_(common) {
    if (!common_.quiet)
      fmt::print(stderr, "  {:<24}{:<18}{:>10}{:>12}{:>8}{:>12}\n", "", "operation", "ms",
                 "ms (proc.)", "goal", "iterations");
  }

  /// Time until the pieces of a cut are there to be drawn.
  void preview(const std::string& name, const std::string& what, const Case& patient,
               const CutStep& step, double goal_ms) {
    MeasuredTimes measured;
    for (int i = 0; i <= options_.repeats; ++i) {
      const Stopwatch watch;
      const PlacedOsteotomy placed = place_osteotomy(patient, step);
      for (const Part& part : patient.parts)
        if (part.name == placed.part) cut_bone(part.mesh, placed.cuts);
      if (i > 0) measured.add(watch);
    }
    add_row(name, what, measured, goal_ms);
  }

  void predict(const BenchOperation& operation) {
    MeasuredTimes applied, first, changed, settled;
    PredictionSettings settings;
    settings.threads = common_.threads;
    Prediction begun, moved;
    int iterations = 0;
    for (int i = 0; i < options_.repeats; ++i) {
      Predictor predictor(*operation.patient, settings);
      const Stopwatch apply;
      predictor.prepare(operation.plan);
      applied.add(apply);
      const Stopwatch face;
      begun = predictor.predict(operation.plan);
      first.add(face);
      const Stopwatch change;
      const Operated& at = predictor.prepare(operation.changed);
      iterations = predictor.move(at.poses).state.iterations;
      changed.add(change);
      const Stopwatch settle;
      moved = predictor.predict(operation.changed);
      settled.add(settle);
    }
    add_row("plan.applied", operation.name, applied, 5000);
    add_row("face.first", operation.name, first, 2000, &begun);
    add_row("face.changed", operation.name, changed, 300);
    results_.back()["iterations"] = iterations;
    add_row("face.settled", operation.name, settled, 2000, &moved);
  }

  void print_json() const {
    const Json json{{"machine", machine_json()}, {"results", results_}};
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  }

 private:
  void add_row(const std::string& name, const std::string& operation, const MeasuredTimes& measured,
               double goal_ms, const Prediction* prediction = nullptr) {
    const Quantiles times = quantiles(measured.wall);
    Json row{{"name", name},
             {"median", times.median},
             {"p95", times.p95},
             {"unit", "ms"},
             {"cpu_median", quantiles(measured.cpu).median},
             {"operation", operation},
             {"samples", measured.wall.size()},
             {"threads", common_.threads},
             {"goal", goal_ms}};
    if (prediction) {
      row["iterations"] = prediction->state.iterations;
      row["converged"] = prediction->state.converged;
      row["unsettled_mm"] = prediction->unsettled_mm;
      row["inverted_prisms"] = prediction->state.inverted_prisms;
    }
    if (!common_.quiet)
      fmt::print(stderr, "  {:<24}{:<18}{:>10.1f}{:>12.1f}{:>8.0f}{:>12}\n", name, operation,
                 times.median, row["cpu_median"].get<double>(), goal_ms,
                 prediction ? fmt::format("{}{}", prediction->state.iterations,
                                          prediction->state.converged ? "" : " *")
                            : "");
    results_.push_back(std::move(row));
  }

  const BenchOptions& options_;
  const CommonOptions& common_;
  Json results_ = Json::array();
};

/// A plane across the body of the jaw.
CutStep plane_step(const Case& patient) {
  const Eigen::Vector3d& point = patient.landmarks.points.at("left_mental_foramen");
  return {
      .target = "mandible",
      .surfaces = {PlanePatch{point + Eigen::Vector3d(8, 10, 0), Eigen::Vector3d::UnitY(), 25.0}},
      .pieces = {"front"},
      .below_margins = true};
}

BenchOperation operation_of(std::string name, const Case& patient, const Plan& cut,
                            const std::string& segment, const std::string& word,
                            const std::string& mm, const std::string& more_mm) {
  return {std::move(name), &patient, with_move(cut, segment, {word, mm}),
          with_move(cut, segment, {word, more_mm})};
}

}  // namespace

int run_bench_predict(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = builtin_patient({}, bar.callback());
  const ClassIiiPlan class_iii = make_class_iii_plan(common.threads, bar.callback());
  const Plan begun = begin_plan(patient, "bench");
  const Plan chin = with_cut(patient, begun, {.osteotomy = "genioplasty"}),
             maxilla = with_cut(patient, begun, {.osteotomy = "le_fort_1"}),
             split = with_cut(patient, begun, {.osteotomy = "sagittal_split"});
  // The upper jaw 0.5 mm farther forward, the rest as before.
  const Plan farther =
      with_move(class_iii.plan, "maxilla", {"forward", "4.5", "up", "2", "pns", "up", "4"});
  bar.clear();

  PredictBench bench(options, common);
  bench.preview("cut.preview", "plane", patient, plane_step(patient), 100);
  bench.preview("osteotomy.preview", "sagittal_split", patient, {.osteotomy = "sagittal_split"},
                300);
  bench.preview("osteotomy.preview", "le_fort_1", patient, {.osteotomy = "le_fort_1"}, 300);
  for (const BenchOperation& operation :
       {operation_of("genioplasty", patient, chin, "chin", "forward", "6", "6.5"),
        operation_of("le_fort_1", patient, maxilla, "maxilla", "forward", "5", "5.5"),
        operation_of("sagittal_split", patient, split, "distal", "back", "5", "5.5"),
        BenchOperation{"class_iii", &class_iii.patient, class_iii.plan, farther}})
    bench.predict(operation);
  if (!common.quiet) fmt::print(stderr, "  * not converged\n");
  if (common.json) bench.print_json();
  return 0;
}

}  // namespace condyle
