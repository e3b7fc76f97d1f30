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

/// Frames of half a degree from 10 to 10 + frames/2 degrees, at the pace of the frame loop while
/// they keep to it; factors are made beside it. Each frame starts from the last one, taken on by
/// the bones' motion and what the tissue's last two own motions foretell. A frame's time has in it
/// what it waited for a factor.
Json warm_frames(const SyntheticSet& set, int frames, int threads) {
  constexpr std::chrono::microseconds pace(8333);
  MinimizeSettings settings;
  settings.tolerance_mm = 4e-3;
  const auto pose_at = [](int frame) {
    return synthetic_pose((10 + 0.5 * frame) * degree, Eigen::Vector3d::Zero());
  };
  const NetLoads rest_loads = synthetic_loads(set, Pose{});
  const auto at_rest =
      std::make_shared<const HessianFactor>(set.net, rest_loads, set.sheets, set.rest, threads);
  const auto settle = [&](int frame, const HessianFactor& factor, Nodes& nodes, double tolerance) {
    MinimizeSettings tight;
    tight.tolerance_mm = tolerance;
    tight.max_iterations = 20000;
    const NetLoads loads = synthetic_loads(set, pose_at(frame));
    SpringPrismEnergy energy(set.net, loads, threads);
    if (!minimize_refreshing(set.net, loads, energy, factor, tight, nodes).converged())
      throw MachineError("bench: the reference did not converge");
  };
  Nodes x = set.rest;
  settle(-1, *at_rest, x, 1e-4);
  RollingFactor factor(at_rest);
  factor.replace(std::make_shared<const HessianFactor>(
      at_rest->anew(set.net, synthetic_loads(set, pose_at(-1)), x, threads)));

  // What the last frames added to the bones' motion.
  Nodes own(x.size(), Eigen::Vector3d::Zero()), own_before = own;
  std::vector<double> wall, cpu, waited;
  std::vector<std::pair<int, Nodes>> samples;
  int iterations = 0;
  auto next_frame = std::chrono::steady_clock::now();
  for (int frame = 0; frame < frames; ++frame) {
    std::this_thread::sleep_until(next_frame);
    next_frame = std::max(next_frame + pace, std::chrono::steady_clock::now());
    const NetLoads loads = synthetic_loads(set, pose_at(frame));
    SpringPrismEnergy energy(set.net, loads, threads);
    const Stopwatch watch;
    factor.advance();
    waited.push_back(watch.wall_ms());
    const Nodes taken = carried(set, x, pose_at(frame - 1), pose_at(frame));
    Nodes next = taken;
    for (std::size_t i = 0; i < next.size(); ++i) next[i] += 2 * own[i] - own_before[i];
    const auto solve = [&] {
      return minimize_refreshing(set.net, loads, energy, factor.now(), settings, next,
                                 {.first = 12, .far = 0});
    };
    MinimizeResult result = solve();
    if (result.status == MinimizeResult::Status::bad_start) {
      next = x;
      result = solve();
    }
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
    iterations += result.iterations;
    if (result.iterations > 0) factor.begin(set.net, loads, next, threads, nullptr);
    own.swap(own_before);
    for (std::size_t i = 0; i < next.size(); ++i) own[i] = next[i] - taken[i];
    x = next;
    if (frame % 5 == 4) samples.emplace_back(frame, x);
  }
  double worst_error = 0;
  for (const auto& [frame, nodes] : samples) {
    Nodes reference = nodes;
    settle(frame, *at_rest, reference, 1e-7);
    worst_error = std::max(worst_error, largest_distance(nodes, reference));
  }
  Json json = result_json({"tissue.warm", set.net.node_count, threads, "condyle"}, quantiles(wall),
                          quantiles(cpu).median, worst_error);
  json["frames"] = frames;
  json["iterations"] = static_cast<double>(iterations) / frames;
  json["waited_p95_ms"] = quantiles(waited).p95;
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
        stderr, "  {:<13}{:<20}{:>8}{:>8}{:>12}{:>12}{:>12}{:>12}\n",
        row["name"].get<std::string>(),
        row.contains("method") ? row["method"].get<std::string>() : "", row["nodes"].get<int>(),
        row["threads"].get<int>(), time("median"), time("p95"), time("cpu_median"),
        row.contains("error_mm") ? fmt::format("{:.1e}", row["error_mm"].get<double>()) : "");
  };
  if (!common.quiet)
    fmt::print(stderr, "ms  {:<9}{:<20}{:>8}{:>8}{:>12}{:>12}{:>12}{:>12}\n", "", "method", "nodes",
               "threads", "median", "p95", "processor", "error mm");

  // Cold, against the published method.
  const TissueTarget target = make_target(make_synthetic_set(patient2_size()), bench_movement());
  const SyntheticSet& set = target.set;
  std::vector<double> setup, setup_cpu;
  for (int i = 0; i < 5; ++i) {
    const Stopwatch watch;
    const HessianFactor factor(set.net, target.rest_loads, set.sheets, set.rest);
    setup.push_back(watch.wall_ms());
    setup_cpu.push_back(watch.cpu_ms());
  }
  say(result_json({"tissue.setup", set.net.node_count, 1, "condyle"}, quantiles(setup),
                  quantiles(setup_cpu).median, 0));
  for (int threads : {1, 2}) {
    const HessianFactor factor(set.net, target.rest_loads, set.sheets, set.rest, threads);
    const auto condyle_solve = [&](double tolerance, Nodes& x, const HessianFactor& from) {
      SpringPrismEnergy energy(set.net, target.loads, threads);
      MinimizeSettings settings;
      settings.tolerance_mm = tolerance;
      return minimize_refreshing(set.net, target.loads, energy, from, settings, x).energy;
    };
    const int repeats = options.repeats * 3;
    say(race_json({"tissue.cold", set.net.node_count, threads, "condyle"},
                  race(target, repeats, [&](double tolerance, Nodes& x) {
                    return condyle_solve(tolerance, x, factor);
                  })));
    say(race_json({"tissue.cold", set.net.node_count, threads, "condyle with setup"},
                  race(target, repeats, [&](double tolerance, Nodes& x) {
                    const HessianFactor own(set.net, target.rest_loads, set.sheets, set.rest,
                                            threads);
                    return condyle_solve(tolerance, x, own);
                  })));
    say(race_json({"tissue.cold", set.net.node_count, threads, "cg_parabolic"},
                  race(target, options.repeats, [&](double tolerance, Nodes& x) {
                    SpringPrismEnergy energy(set.net, target.loads, threads);
                    MinimizeSettings settings;
                    settings.tolerance_mm = tolerance;
                    settings.max_iterations = 20000;
                    return minimize(Method::cg_parabolic, energy, settings, x).energy;
                  })));
  }
  const Json peers = peer_results();
  if (peers.empty() && !common.quiet)
    fmt::print(stderr, "  (condyle-peers is not built: tools/setup --bench)\n");
  for (const auto& row : peers)
    if (row["name"] == "tissue.peer") say(row);

  for (int threads : {1, 2}) say(warm_frames(set, 60, threads));
  for (int nodes : options.sizes) {
    const SyntheticSet large = make_synthetic_set(size_of_nodes(nodes));
    say(warm_frames(large, nodes > 30000 ? 5 : 20, 2));
  }

  // One prediction for each, from nothing, as before and after surgery.
  std::vector<int> sizes{20000};
  sizes.insert(sizes.end(), options.sizes.begin(), options.sizes.end());
  for (int nodes : sizes)
    for (int threads : {1, 2}) say(static_prediction(nodes, threads));

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
