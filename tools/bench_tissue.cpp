// Speed of the tissue's minimiser: a cold solve against the published method and other libraries,
// warm frames of a steady opening, and sizes beyond those of the frame loop.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "engine/core/error.h"
#include "engine/tissue/refreshing.h"
#include "tools/commands.h"
#include "tools/tissue_target.h"

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

/// Frames of half a degree from 10 to 10 + frames/2 degrees. The factor is made anew every sixth
/// frame, apart, as beside a loop; each frame starts from the last one, taken on by the bones'
/// motion and the tissue's last own motion.
Json warm_frames(const SyntheticSet& set, int frames, int threads) {
  constexpr int factor_every = 6;
  MinimizeSettings settings;
  settings.tolerance_mm = 3e-3;
  std::vector<double> wall, cpu, factor_ms;
  double worst_error = 0;
  int iterations = 0;
  const auto pose_at = [](int frame) {
    return synthetic_pose((10 + 0.5 * frame) * degree, Eigen::Vector3d::Zero());
  };
  Nodes x = set.rest;
  const NetLoads rest_loads = synthetic_loads(set, Pose{});
  HessianFactor factor(set.net, rest_loads, set.sheets, set.rest);
  const auto settle = [&](int frame, Nodes& nodes, double tolerance_mm) {
    MinimizeSettings tight;
    tight.tolerance_mm = tolerance_mm;
    tight.max_iterations = 20000;
    const NetLoads loads = synthetic_loads(set, pose_at(frame));
    SpringPrismEnergy energy(set.net, loads, threads);
    if (!minimize_refreshing(set.net, loads, energy, factor, tight, nodes).converged())
      throw MachineError("bench: the reference did not converge");
  };
  settle(-1, x, 1e-4);
  Nodes own(x.size(), Eigen::Vector3d::Zero());  // what the last frame added to the bones' motion
  for (int frame = 0; frame < frames; ++frame) {
    const NetLoads loads = synthetic_loads(set, pose_at(frame));
    if (frame % factor_every == 0) {
      const Stopwatch watch;
      factor.refactor(set.net, synthetic_loads(set, pose_at(frame - 1)), x);
      factor_ms.push_back(watch.wall_ms());
    }
    SpringPrismEnergy energy(set.net, loads, threads);
    const Stopwatch watch;
    const Nodes taken = carried(set, x, pose_at(frame - 1), pose_at(frame));
    Nodes next = taken;
    for (std::size_t i = 0; i < next.size(); ++i) next[i] += own[i];
    if (!std::isfinite(energy.value(next))) next = x;
    const MinimizeResult result = minimize(Method::preconditioned, energy, settings, next, &factor);
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
    iterations += result.iterations;
    for (std::size_t i = 0; i < next.size(); ++i) own[i] = next[i] - taken[i];
    x = next;
    if (frame % 5 == 4) {
      Nodes reference = x;
      settle(frame, reference, 1e-7);
      worst_error = std::max(worst_error, largest_distance(x, reference));
    }
  }
  Json json = result_json({"tissue.warm", set.net.node_count, threads, "condyle"}, quantiles(wall),
                          quantiles(cpu).median, worst_error);
  json["frames"] = frames;
  json["iterations"] = static_cast<double>(iterations) / frames;
  json["factor_ms"] = quantiles(factor_ms).median;
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
  const HessianFactor factor(set.net, target.rest_loads, set.sheets, set.rest);
  for (int threads : {1, 2}) {
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
                    const HessianFactor own(set.net, target.rest_loads, set.sheets, set.rest);
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
  if (common.json) fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
