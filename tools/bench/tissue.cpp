// Speed of the tissue's minimiser: a cold solve against the published method and other libraries,
// warm frames of a steady opening, and sizes beyond those of the frame loop.
#include <fmt/format.h>

#include <cstdio>

#include "engine/tissue/refactorization.h"
#include "tools/bench/baseline/baseline_minimizers.h"
#include "tools/bench/bench.h"
#include "tools/bench/tissue_kernels.h"
#include "tools/bench/tissue_tables.h"
#include "tools/bench/tissue_warm.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

Json race_json(const TimingLine& line, const Race& result) {
  Json json = timing_json(line, {result.median_ms, result.p95_ms}, result.cpu_ms, result.error_mm);
  json["energy_error"] = result.energy_error;
  json["tolerance"] = result.tolerance;
  json["met_target"] = result.met;
  if (!result.met) json["median"] = json["p95"] = nullptr;
  return json;
}

/// One solve of the target by the production method. Returns the energy.
double solve_with_factor(const TissueTarget& target, double tolerance, int threads, Nodes& x,
                         const HessianFactor& from, const RefactorPolicy& schedule) {
  const SyntheticSet& set = target.set;
  SpringPrismEnergy energy(set.mesh, target.loads, threads, target.batches);
  MinimizeSettings settings;
  settings.tolerance_mm = tolerance;
  settings.max_step_mm = bench_step_mm;
  return minimize_with_refactorization(set.mesh, target.loads, energy, from, settings, x, schedule)
      .energy;
}

/// One solve of the target by the published method. Returns the energy.
double solve_as_published(const TissueTarget& target, double tolerance, int threads, Nodes& x) {
  SpringPrismEnergy energy(target.set.mesh, target.loads, threads, target.batches);
  MinimizeSettings settings;
  settings.tolerance_mm = tolerance;
  settings.max_iterations = 20000;
  return minimize_with(Method::cg_parabolic, energy, settings, x).energy;
}

/// Collects the rows of the benchmark and prints each as soon as it is measured.
class TissueBench {
 public:
  TissueBench(const BenchOptions& options, const CommonOptions& common)
      : options_(options),
        common_(common),
        target_(make_target(make_synthetic_set(patient2_size()), bench_movement())) {
    json_["machine"] = machine_json();
    json_["results"] = Json::array();
    if (!common.quiet)
      fmt::print(stderr, "ms  {:<12}{:<20}{:<16}{:>8}{:>8}{:>12}{:>12}{:>12}{:>12}\n", "", "method",
                 "start", "nodes", "threads", "median", "p95", "processor", "error mm");
  }

  Json run() {
    time_setup();
    for (int threads : {1, 2}) race_cold(threads);
    add_peers();
    for (const bool crushed : {false, true}) time_warm(crushed);
    predict();
    compare_tolerances();
    compare_kernels();
    return std::move(json_);
  }

 private:
  void add(const Json& row) {
    json_["results"].push_back(row);
    if (common_.quiet) return;
    const auto time = [&](const char* key) {
      return row[key].is_null() ? std::string("-") : fmt::format("{:.2f}", row[key].get<double>());
    };
    fmt::print(
        stderr, "  {:<14}{:<20}{:<16}{:>8}{:>8}{:>12}{:>12}{:>12}{:>12}\n",
        row["name"].get<std::string>(),
        row.contains("method") ? row["method"].get<std::string>() : "",
        row.contains("start") ? row["start"].get<std::string>() : "", row["nodes"].get<int>(),
        row["threads"].get<int>(), time("median"), time("p95"), time("cpu_median"),
        row.contains("error_mm") ? fmt::format("{:.1e}", row["error_mm"].get<double>()) : "");
  }

  /// With the rim below the hinge moving with the jaw, or crushed against a rim that stays.
  void time_warm(bool crushed) {
    const auto set_of = [&](SyntheticSize size) {
      size.rim_moves = !crushed;
      return make_synthetic_set(size);
    };
    const char* name = crushed ? "tissue.crushed" : "tissue.warm";
    for (int threads : {1, 2}) add(warm_frames(set_of(patient2_size()), threads, name));
    for (int nodes : options_.sizes) add(warm_frames(set_of(size_of_nodes(nodes)), 2, name));
  }

  void time_setup() {
    const SyntheticSet& set = target_.set;
    std::vector<double> setup, setup_cpu;
    for (int i = 0; i < 5; ++i) {
      const Stopwatch watch;
      const HessianFactor factor(set.mesh, target_.rest_loads, set.sheets, set.rest);
      const StoredOpening stored(target_, factor, 1);
      setup.push_back(watch.wall_ms());
      setup_cpu.push_back(watch.cpu_ms());
    }
    add(timing_json({"tissue.setup", set.mesh.node_count, 1, "condyle"}, quantiles(setup),
                    quantiles(setup_cpu).median, 0));
  }

  /// Cold, against the published method, each from rest and from the stored opening of the setup,
  /// as the simulator starts. "foretelling" starts at rest and includes the time to get from there
  /// to the stored opening, "with setup" includes the factorisation.
  void race_cold(int threads) {
    const SyntheticSet& set = target_.set;
    constexpr RefactorPolicy from_stored{.first = 1, .far = 0};
    const HessianFactor factor(set.mesh, target_.rest_loads, set.sheets, set.rest, threads);
    const StoredOpening stored(target_, factor, threads);
    const auto row = [&](const char* method, int times,
                         const std::function<double(double tolerance, Nodes& x)>& attempt) {
      Json json_row = race_json({"tissue.cold", set.mesh.node_count, threads, method},
                                race(target_, times, attempt));
      json_row["start"] = target_.begun.empty() ? "rest" : "stored opening";
      add(json_row);
    };
    const int repeats = options_.repeats * 3;
    for (const bool at_rest : {true, false}) {
      target_.begun = at_rest ? Nodes() : stored.start(target_, bench_movement());
      if (at_rest)
        row("condyle with setup", repeats, [&](double tolerance, Nodes& x) {
          const HessianFactor own(set.mesh, target_.rest_loads, set.sheets, set.rest, threads);
          return solve_with_factor(target_, tolerance, threads, x, own, {});
        });
      if (at_rest)
        row("condyle foretelling", repeats, [&](double tolerance, Nodes& x) {
          x = stored.start(target_, bench_movement());
          return solve_with_factor(target_, tolerance, threads, x, stored.factor, from_stored);
        });
      row("condyle", repeats, [&](double tolerance, Nodes& x) {
        return at_rest
                   ? solve_with_factor(target_, tolerance, threads, x, factor, {})
                   : solve_with_factor(target_, tolerance, threads, x, stored.factor, from_stored);
      });
      row("cg_parabolic", options_.repeats, [&](double tolerance, Nodes& x) {
        return solve_as_published(target_, tolerance, threads, x);
      });
    }
    target_.begun.clear();
  }

  void add_peers() {
    const Json peers = output_of_companion("condyle-peers", "table2");
    if (peers.empty() && !common_.quiet)
      fmt::print(stderr, "  (condyle-peers is not built: tools/setup --bench)\n");
    for (const auto& row : peers.empty() ? Json::array() : peers["results"])
      if (row["name"] == "tissue.peer") add(row);
  }

  /// One prediction for each size, from nothing, as before and after surgery.
  void predict() {
    std::vector<int> sizes{20000};
    sizes.insert(sizes.end(), options_.sizes.begin(), options_.sizes.end());
    for (int nodes : sizes)
      for (int threads : {1, 2})
        if (threads == 2 || nodes <= 20000) add(static_prediction(nodes, threads));
  }

  void compare_tolerances() {
    const Json tolerances = tolerance_rows(target_, 5);
    for (const auto& row : tolerances) json_["results"].push_back(row);
    if (common_.quiet) return;
    fmt::print(stderr, "Tolerance against time and error, {} nodes, cold, one thread:\n",
               target_.set.mesh.node_count);
    fmt::print(stderr, "  {:>13}{:>12}{:>12}{:>14}{:>17}\n", "tolerance mm", "median ms",
               "iterations", "worst node mm", "relative energy");
    for (const auto& row : tolerances)
      fmt::print(stderr, "  {:>13.1e}{:>12.2f}{:>12}{:>14.1e}{:>17.1e}\n",
                 row["tolerance"].get<double>(), row["median"].get<double>(),
                 row["iterations"].get<int>(), row["error_mm"].get<double>(),
                 row["energy_error"].get<double>());
  }

  void compare_kernels() {
    Json kernels = factor_rows();
    if (kernels.empty() && !common_.quiet)
      fmt::print(stderr, "  (condyle-factors is not built: tools/setup)\n");
    for (auto& row : element_rows({2000, 8000})) kernels.push_back(std::move(row));
    if (!common_.quiet) print_kernel_rows(kernels);
    for (auto& row : kernels) json_["results"].push_back(std::move(row));
  }

  const BenchOptions& options_;
  const CommonOptions& common_;
  TissueTarget target_;
  Json json_;
};

}  // namespace

int run_bench_tissue(const BenchOptions& options, const CommonOptions& common) {
  const Json json = TissueBench(options, common).run();
  if (common.json) fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
