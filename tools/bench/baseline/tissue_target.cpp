#include "tools/bench/baseline/tissue_target.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <thread>

#include "engine/core/error.h"
#include "engine/tissue/refactorization.h"

namespace condyle {
namespace {

double clock_ms(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

}  // namespace

TissueTarget make_target(SyntheticSet set, const Pose& lower_bone) {
  TissueTarget target{.set = std::move(set)};
  target.batches = std::make_shared<const ElementBatches>(target.set.mesh);
  target.rest_loads = synthetic_loads(target.set, Pose{});
  target.loads = synthetic_loads(target.set, lower_bone);
  target.converged = target.start();
  const HessianFactor factor(target.set.mesh, target.rest_loads, target.set.sheets, target.start());
  SpringPrismEnergy energy(target.set.mesh, target.loads, 1, target.batches);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-7;
  const auto result = minimize_with_refactorization(target.set.mesh, target.loads, energy, factor,
                                                    settings, target.converged);
  if (!result.converged()) throw MachineError("bench: the reference did not converge");
  target.converged_energy = result.energy;
  return target;
}

Pose bench_movement() { return synthetic_pose(0.0873, {0, -2, -2}); }

StoredOpening::StoredOpening(const TissueTarget& target, const HessianFactor& at_rest, int threads)
    : nodes(target.set.rest), factor(at_rest) {
  const SpringPrismMesh& mesh = target.set.mesh;
  const MeshLoads loads = synthetic_loads(target.set, synthetic_pose(opened_rad, {0, 0, 0}));
  SpringPrismEnergy energy(mesh, loads, threads, target.batches);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-2;
  settings.max_step_mm = bench_step_mm;
  minimize_with_refactorization(mesh, loads, energy, at_rest, settings, nodes);
  factor = at_rest.anew(mesh, loads, nodes, threads);
}

Nodes StoredOpening::start(const TissueTarget& target, const Pose& lower_bone) const {
  const double fraction = std::clamp(rotation_angle(lower_bone) / opened_rad, 0.0, 1.0);
  Nodes x = target.set.rest;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += fraction * (nodes[i] - x[i]);
  return x;
}

double largest_distance(const Nodes& a, const Nodes& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

Race race(const TissueTarget& target, int repeats,
          const std::function<double(double tolerance, Nodes& x)>& attempt) {
  Race result;
  Nodes x;
  for (int rung = 2; rung <= 18 && !result.met; ++rung) {
    result.tolerance = std::pow(10, -0.5 * rung);
    x = target.start();
    const double energy = attempt(result.tolerance, x);
    result.error_mm = largest_distance(x, target.converged);
    result.energy_error = (energy - target.converged_energy) / target.converged_energy;
    result.met = result.error_mm < target_mm && result.energy_error < target_energy;
  }
  std::vector<double> wall, cpu;
  for (int i = 0; i < repeats && result.met; ++i) {
    x = target.start();
    const Stopwatch watch;
    attempt(result.tolerance, x);
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
  }
  const Quantiles times = quantiles(wall);
  result.median_ms = times.median;
  result.p95_ms = times.p95;
  result.cpu_ms = quantiles(cpu).median;
  return result;
}

Quantiles quantiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double fraction) {
    return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1) +
                                           0.5)];
  };
  return {at(0.5), at(0.95)};
}

Stopwatch::Stopwatch()
    : wall_(clock_ms(CLOCK_MONOTONIC)), cpu_(clock_ms(CLOCK_PROCESS_CPUTIME_ID)) {}
double Stopwatch::wall_ms() const { return clock_ms(CLOCK_MONOTONIC) - wall_; }
double Stopwatch::cpu_ms() const { return clock_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_; }

nlohmann::ordered_json timing_json(const TimingLine& line, const Quantiles& times, double cpu_ms,
                                   double error_mm) {
  return {{"name", line.name},       {"median", times.median},
          {"p95", times.p95},        {"unit", "ms"},
          {"cpu_median", cpu_ms},    {"nodes", line.nodes},
          {"threads", line.threads}, {"method", line.method},
          {"error_mm", error_mm}};
}

nlohmann::ordered_json machine_json() {
  std::string processor = "unknown";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) {
      processor = line.substr(line.find(':') + 2);
      break;
    }
  return {{"processor", processor}, {"cores", std::thread::hardware_concurrency()}};
}

}  // namespace condyle
