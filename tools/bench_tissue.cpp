// Speed of the tissue's minimiser: a cold solve against the published method and other libraries,
// warm frames of a steady opening, and sizes beyond those of the frame loop.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "engine/core/error.h"
#include "engine/tissue/refreshing.h"
#include "engine/tissue/rolling_factor.h"
#include "tools/commands.h"
#include "tools/tissue_tables.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degree = 3.14159265358979 / 180;

struct Line {
  const char* name;
  int nodes, threads;
  std::string method;
};
Json result_json(const Line& line, const Quantiles& times, double cpu_ms, double error_mm) {
  return {{"name", line.name},       {"median", times.median},
          {"p95", times.p95},        {"unit", "ms"},
          {"cpu_median", cpu_ms},    {"nodes", line.nodes},
          {"threads", line.threads}, {"method", line.method},
          {"error_mm", error_mm}};
}

Json race_json(const Line& line, const Race& result) {
  Json json = result_json(line, {result.median_ms, result.p95_ms}, result.cpu_ms, result.error_mm);
  json["energy_error"] = result.energy_error;
  json["tolerance"] = result.tolerance;
  json["met_target"] = result.met;
  if (!result.met) json["median"] = json["p95"] = nullptr;
  return json;
}

Nodes difference(const Nodes& a, const Nodes& b) {
  Nodes d = a;
  for (std::size_t i = 0; i < d.size(); ++i) d[i] -= b[i];
  return d;
}

/// How many frames, and how exactly errors are measured: large tissues get less of both.
struct WarmPlan {
  double from_deg = 10;
  int frames = 60, samples_every = 1;
  int budget = 40;             // iterations of a frame
  double reference_mm = 1e-7;  // tolerance of the answers that errors are measured against
  double lead_mm = 1e-3;       // of the frames before the first
  RefreshSchedule from_rest = {}, near = {.first = 12, .far = 0};
};
WarmPlan plan_for(int nodes) {
  if (nodes < 5000) return {};
  const bool huge = nodes > 30000;
  return {.from_deg = huge ? 2.0 : 5.0,
          .frames = huge ? 4 : 20,
          .samples_every = huge ? 4 : 5,
          .budget = huge ? 12 : 40,
          .reference_mm = huge ? 1e-3 : 1e-4,
          .lead_mm = huge ? 1e-2 : 1e-3,
          .from_rest = sparing_refreshes,
          .near = {.first = 20, .far = 0, .later = 20, .most = 20}};
}

/// Frames of half a degree, at the pace of the frame loop while they keep to it; factors are made
/// beside it, and with one thread in the time between frames, which is told. Each frame starts from
/// the last one, taken on by the bones' motion and what the tissue's last two own motions foretell.
/// A frame's time has in it what it waited for a factor. A frame that has spent its budget is left
/// as it is.
Json warm_frames(const SyntheticSet& set, int threads) {
  constexpr std::chrono::microseconds pace(8333);
  const WarmPlan plan = plan_for(set.net.node_count);
  MinimizeSettings settings;
  settings.tolerance_mm = 5e-3;
  settings.max_iterations = plan.budget;
  const auto pose_at = [&](int frame) {
    return synthetic_pose((plan.from_deg + 0.5 * frame) * degree, Eigen::Vector3d::Zero());
  };
  const NetLoads rest_loads = synthetic_loads(set, Pose{});
  const auto settle = [&](int frame, const HessianFactor& factor, Nodes& nodes, double tolerance,
                          const RefreshSchedule& schedule) {
    MinimizeSettings tight;
    tight.tolerance_mm = tolerance;
    tight.max_step_mm = bench_step_mm;
    const NetLoads loads = synthetic_loads(set, pose_at(frame));
    SpringPrismEnergy energy(set.net, loads, threads);
    const auto result = minimize_refreshing(set.net, loads, energy, factor, tight, nodes, schedule);
    if (!result.converged()) throw MachineError("bench: the reference did not converge");
    return result.energy;
  };
  // The motion is under way when the clock starts.
  constexpr int lead = 3;
  Nodes x = set.rest;
  std::shared_ptr<const HessianFactor> first =
      std::make_shared<const HessianFactor>(set.net, rest_loads, set.sheets, set.rest, threads);
  settle(-lead, *first, x, plan.lead_mm, plan.from_rest);
  Nodes own, own_before;  // what the last frames added to the bones' motion
  for (int frame = 1 - lead; frame < 0; ++frame) {
    first = std::make_shared<const HessianFactor>(
        first->anew(set.net, synthetic_loads(set, pose_at(frame - 1)), x, threads));
    const Nodes taken = carried(set, x, pose_at(frame - 1), pose_at(frame));
    settle(frame, *first, x, plan.lead_mm, plan.near);
    own.swap(own_before);
    own = difference(x, taken);
  }
  RollingFactor factor(first);

  std::vector<double> wall, cpu, waited, beside, steps;
  NetLoads loads = synthetic_loads(set, pose_at(0));
  SpringPrismEnergy energy(set.net, loads, threads);
  struct Sample {
    int frame;
    Nodes nodes;
    double energy;
  };
  std::vector<Sample> samples;
  int spent = 0;
  double residual = 0;
  auto next_frame = std::chrono::steady_clock::now();
  for (int frame = 0; frame < plan.frames; ++frame) {
    std::this_thread::sleep_until(next_frame);
    next_frame = std::max(next_frame + pace, std::chrono::steady_clock::now());
    const Stopwatch watch;
    loads = synthetic_loads(set, pose_at(frame));
    factor.advance();
    waited.push_back(watch.wall_ms());
    const Nodes taken = carried(set, x, pose_at(frame - 1), pose_at(frame));
    Nodes next = taken;
    // Where the tissue has just snapped over, its last motion foretells nothing.
    constexpr double steady_mm = 0.3;
    if (largest_distance(own, own_before) < steady_mm)
      for (std::size_t i = 0; i < next.size(); ++i) next[i] += 2 * own[i] - own_before[i];
    MinimizeResult result = minimize(Method::preconditioned, energy, settings, next, &factor.now());
    if (result.status == MinimizeResult::Status::bad_start) {
      next = x;
      result = minimize(Method::preconditioned, energy, settings, next, &factor.now());
    }
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
    steps.push_back(result.iterations);
    spent += !result.converged();
    residual = std::max(residual, result.residual);
    constexpr int worth_making = 1;
    if (result.iterations >= worth_making) factor.begin(set.net, loads, next, threads, nullptr);
    if (threads == 1) {
      const Stopwatch between;
      factor.finish();
      beside.push_back(between.wall_ms());
    }
    own.swap(own_before);
    own = difference(next, taken);
    x = next;
    if (frame % plan.samples_every == plan.samples_every - 1)
      samples.push_back({frame, x, result.energy});
  }
  double worst_error = 0, worst_energy = 0;
  for (const auto& [frame, nodes, reached] : samples) {
    Nodes reference = nodes;
    const HessianFactor fresh =
        first->anew(set.net, synthetic_loads(set, pose_at(frame)), nodes, threads);
    const double least = settle(frame, fresh, reference, plan.reference_mm, plan.near);
    worst_error = std::max(worst_error, largest_distance(nodes, reference));
    worst_energy = std::max(worst_energy, (reached - least) / least);
  }
  Json json = result_json({"tissue.warm", set.net.node_count, threads, "condyle"}, quantiles(wall),
                          quantiles(cpu).median, worst_error);
  json["energy_error"] = worst_energy;
  json["cpu_p95"] = quantiles(cpu).p95;
  json["frames"] = plan.frames;
  json["iterations"] = quantiles(steps).median;
  json["iterations_p95"] = quantiles(steps).p95;
  json["frames_cut_short"] = spent;
  json["residual_N"] = residual;
  json["waited_p95_ms"] = quantiles(waited).p95;
  if (threads == 1) json["factor_between_frames_ms"] = quantiles(beside).median;
  return json;
}

/// The figures of condyle-peers beside this program, if it was built.
Json peer_results() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto program = self.parent_path() / "condyle-peers";
  if (error || !std::filesystem::exists(program)) return {};
  std::string output;
  FILE* pipe = popen(("'" + program.string() + "' table2 2>/dev/null").c_str(), "r");
  if (!pipe) return {};
  char buffer[4096];
  while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, pipe))
    output.append(buffer, count);
  if (pclose(pipe) != 0) throw MachineError(program.string() + ": failed");
  return Json::parse(output)["results"];
}

}  // namespace

int run_bench_tissue(const BenchOptions& options, const CommonOptions& common) {
  Json json;
  json["machine"] = machine_json();
  auto& results = json["results"] = Json::array();
  const auto say = [&](const Json& row) {
    results.push_back(row);
    if (common.quiet) return;
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
  };
  if (!common.quiet)
    fmt::print(stderr, "ms  {:<12}{:<20}{:<16}{:>8}{:>8}{:>12}{:>12}{:>12}{:>12}\n", "", "method",
               "start", "nodes", "threads", "median", "p95", "processor", "error mm");

  // Cold, against the published method, each from rest and from what the setup has stored, as the
  // simulator begins; "with setup" makes its factor first.
  TissueTarget target = make_target(make_synthetic_set(patient2_size()), bench_movement());
  const SyntheticSet& set = target.set;
  std::vector<double> setup, setup_cpu;
  for (int i = 0; i < 5; ++i) {
    const Stopwatch watch;
    const HessianFactor factor(set.net, target.rest_loads, set.sheets, set.rest);
    const StoredOpening stored(target, factor, 1);
    setup.push_back(watch.wall_ms());
    setup_cpu.push_back(watch.cpu_ms());
  }
  say(result_json({"tissue.setup", set.net.node_count, 1, "condyle"}, quantiles(setup),
                  quantiles(setup_cpu).median, 0));
  const auto condyle_solve = [&](double tolerance, int threads, Nodes& x, const HessianFactor& from,
                                 const RefreshSchedule& schedule) {
    SpringPrismEnergy energy(set.net, target.loads, threads);
    MinimizeSettings settings;
    settings.tolerance_mm = tolerance;
    settings.max_step_mm = bench_step_mm;
    return minimize_refreshing(set.net, target.loads, energy, from, settings, x, schedule).energy;
  };
  constexpr RefreshSchedule from_stored{.first = 20, .far = 0};
  for (int threads : {1, 2}) {
    const HessianFactor factor(set.net, target.rest_loads, set.sheets, set.rest, threads);
    const StoredOpening stored(target, factor, threads);
    const auto row = [&](const char* method, int times,
                         const std::function<double(double tolerance, Nodes& x)>& attempt) {
      Json json_row = race_json({"tissue.cold", set.net.node_count, threads, method},
                                race(target, times, attempt));
      json_row["start"] = target.begun.empty() ? "rest" : "stored opening";
      say(json_row);
    };
    const int repeats = options.repeats * 3;
    for (const bool at_rest : {true, false}) {
      target.begun = at_rest ? Nodes() : stored.start(target, bench_movement());
      if (at_rest)
        row("condyle with setup", repeats, [&](double tolerance, Nodes& x) {
          const HessianFactor own(set.net, target.rest_loads, set.sheets, set.rest, threads);
          return condyle_solve(tolerance, threads, x, own, {});
        });
      row("condyle", repeats, [&](double tolerance, Nodes& x) {
        return at_rest ? condyle_solve(tolerance, threads, x, factor, {})
                       : condyle_solve(tolerance, threads, x, stored.factor, from_stored);
      });
      row("cg_parabolic", options.repeats, [&](double tolerance, Nodes& x) {
        SpringPrismEnergy energy(set.net, target.loads, threads);
        MinimizeSettings settings;
        settings.tolerance_mm = tolerance;
        settings.max_iterations = 20000;
        return minimize(Method::cg_parabolic, energy, settings, x).energy;
      });
    }
  }
  target.begun.clear();
  const Json peers = peer_results();
  if (peers.empty() && !common.quiet)
    fmt::print(stderr, "  (condyle-peers is not built: tools/setup --bench)\n");
  for (const auto& row : peers)
    if (row["name"] == "tissue.peer") say(row);

  for (int threads : {1, 2}) say(warm_frames(set, threads));
  for (int nodes : options.sizes) say(warm_frames(make_synthetic_set(size_of_nodes(nodes)), 2));

  // One prediction for each, from nothing, as before and after surgery.
  std::vector<int> sizes{20000};
  sizes.insert(sizes.end(), options.sizes.begin(), options.sizes.end());
  for (int nodes : sizes)
    for (int threads : {1, 2})
      if (threads == 2 || nodes <= 20000) say(static_prediction(nodes, threads));

  const Json tolerances = tolerance_rows(target, 5);
  for (const auto& row : tolerances) results.push_back(row);
  if (!common.quiet) {
    fmt::print(stderr, "Tolerance against time and error, {} nodes, cold, one thread:\n",
               set.net.node_count);
    fmt::print(stderr, "  {:>13}{:>12}{:>12}{:>14}{:>17}\n", "tolerance mm", "median ms",
               "iterations", "worst node mm", "relative energy");
    for (const auto& row : tolerances)
      fmt::print(stderr, "  {:>13.1e}{:>12.2f}{:>12}{:>14.1e}{:>17.1e}\n",
                 row["tolerance"].get<double>(), row["median"].get<double>(),
                 row["iterations"].get<int>(), row["error_mm"].get<double>(),
                 row["energy_error"].get<double>());
  }
  if (common.json) fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
