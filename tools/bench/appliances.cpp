// Splints and cutting guides of the built-in class III plan.
#include <fmt/format.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/appliance/guide.h"
#include "sim/appliance/plan_arches.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/common.h"
#include "tools/demo/class_iii_plan.h"
#include "tools/demo/plan_steps.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr double appliance_goal_ms = 5000, appliance_voxel_mm = 0.2;

/// Wall times between the calls of a progress callback.
class StageClock {
 public:
  Progress callback() {
    return [this](std::string_view what, double) {
      finish();
      stage_ = what;
    };
  }
  void finish() {
    const auto now = std::chrono::steady_clock::now();
    if (!stage_.empty())
      stages[stage_] = std::chrono::duration<double, std::milli>(now - began_).count();
    began_ = now;
    stage_.clear();
  }
  std::map<std::string, double> stages;

 private:
  std::string stage_;
  std::chrono::steady_clock::time_point began_;
};

class ApplianceBench {
 public:
  ApplianceBench(const BenchOptions& options, const CommonOptions& common)
      : options_(options), common_(common) {
    if (!common_.quiet)
      fmt::print(stderr, "  {:<28}{:>10}{:>12}{:>8}{:>12}  stages, ms\n", "", "ms", "ms (proc.)",
                 "goal", "triangles");
  }

  /// `make` returns the number of triangles.
  void run(const std::string& name, const auto& make) {
    std::vector<double> wall, cpu;
    StageClock clock;
    int triangles = 0;
    for (int i = 0; i < options_.repeats; ++i) {
      const Stopwatch watch;
      triangles = make(clock.callback());
      clock.finish();
      wall.push_back(watch.wall_ms());
      cpu.push_back(watch.cpu_ms());
    }
    const Quantiles times = quantiles(wall);
    if (!common_.quiet) {
      fmt::print(stderr, "  {:<28}{:>10.0f}{:>12.0f}{:>8.0f}{:>12} ", name, times.median,
                 quantiles(cpu).median, appliance_goal_ms, triangles);
      for (const auto& [stage, ms] : clock.stages) fmt::print(stderr, " {} {:.0f};", stage, ms);
      fmt::print(stderr, "\n");
    }
    results_.push_back(Json{{"name", name},
                            {"median", times.median},
                            {"p95", times.p95},
                            {"unit", "ms"},
                            {"cpu_median", quantiles(cpu).median},
                            {"samples", wall.size()},
                            {"threads", common_.threads},
                            {"goal", appliance_goal_ms},
                            {"voxel_mm", appliance_voxel_mm},
                            {"triangles", triangles},
                            {"stages_ms", clock.stages}});
  }

  void print_json() const {
    const Json json{{"machine", machine_json()}, {"results", results_}};
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  }

 private:
  const BenchOptions& options_;
  const CommonOptions& common_;
  Json results_ = Json::array();
};

}  // namespace

int run_bench_appliances(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const ClassIiiPlan class_iii = make_class_iii_plan(common.threads, bar.callback());
  const Plan plan =
      with_cut(class_iii.patient, class_iii.plan, {.osteotomy = "genioplasty", .target = "distal"});
  const Operated operated = apply_plan(class_iii.patient, class_iii.plan);
  const Operated cuts = apply_cuts(class_iii.patient, plan);
  bar.clear();
  ApplianceBench bench(options, common);
  SplintSettings splint;
  splint.voxel_mm = appliance_voxel_mm;
  splint.threads = common.threads;
  for (const auto& [name, kind] : {std::pair("splint.intermediate", SplintKind::intermediate),
                                   std::pair("splint.final", SplintKind::final_bite)})
    bench.run(name, [&, stage = kind](const Progress& progress) {
      return make_splint(splint_arches(operated, stage), splint, progress).measure.triangles;
    });
  GuideSettings guide;
  guide.saw = find_saw("sagittal");
  guide.voxel_mm = appliance_voxel_mm;
  guide.threads = common.threads;
  for (const char* cut : {"le_fort_1", "genioplasty"})
    bench.run(std::string("guide.") + cut, [&](const Progress& progress) {
      const CutLine line = find_cut_line(cuts, plan, cut);
      std::vector<std::string> notes;
      return make_guide(guide_support(class_iii.patient, plan, line, notes), line, guide, progress)
          .measure.triangles;
    });
  if (common.json) bench.print_json();
  return 0;
}

}  // namespace condyle
