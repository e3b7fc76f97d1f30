#include "tools/bench/tissue_tables.h"

#include <cmath>

#include "engine/core/error.h"
#include "engine/tissue/refactorization.h"

namespace condyle {

using Json = nlohmann::ordered_json;

Json tolerance_rows(const TissueTarget& target, int repeats) {
  const SyntheticSet& set = target.set;
  const HessianFactor factor(set.mesh, target.rest_loads, set.sheets, set.rest);
  Json rows = Json::array();
  for (int rung = 0; rung <= 12; ++rung) {
    MinimizeSettings settings;
    settings.tolerance_mm = std::pow(10, -0.5 * rung);
    settings.max_step_mm = bench_step_mm;
    std::vector<double> wall, cpu;
    MinimizeResult result;
    Nodes x;
    for (int i = 0; i < repeats; ++i) {
      x = target.start();
      SpringPrismEnergy energy(set.mesh, target.loads, 1, target.batches);
      const Stopwatch watch;
      result = minimize_with_refactorization(set.mesh, target.loads, energy, factor, settings, x);
      wall.push_back(watch.wall_ms());
      cpu.push_back(watch.cpu_ms());
    }
    const Quantiles times = quantiles(wall);
    rows.push_back(
        {{"name", "tissue.tolerance"},
         {"median", times.median},
         {"p95", times.p95},
         {"unit", "ms"},
         {"cpu_median", quantiles(cpu).median},
         {"nodes", set.mesh.node_count},
         {"threads", 1},
         {"method", "condyle"},
         {"tolerance", settings.tolerance_mm},
         {"iterations", result.iterations},
         {"error_mm", largest_distance(x, target.converged)},
         {"energy_error", (result.energy - target.converged_energy) / target.converged_energy},
         {"converged", result.converged()}});
  }
  return rows;
}

Json static_prediction(int nodes, int threads) {
  MinimizeSettings settings;
  settings.tolerance_mm = 0.03;  // leaves less than target_mm
  settings.max_step_mm = bench_step_mm;
  const Stopwatch whole;
  const SyntheticSet set = make_synthetic_set(size_of_nodes(nodes));
  const double build_ms = whole.wall_ms();
  const MeshLoads loads = synthetic_loads(set, bench_movement());
  const Stopwatch making;
  const HessianFactor factor(set.mesh, synthetic_loads(set, Pose{}), set.sheets, set.rest, threads);
  const double factor_ms = making.wall_ms();
  SpringPrismEnergy energy(set.mesh, loads, threads);
  Nodes x = set.rest;
  const MinimizeResult result =
      minimize_with_refactorization(set.mesh, loads, energy, factor, settings, x,
                                    nodes < 40000 ? large_mesh_policy : largest_mesh_policy);
  const double wall_ms = whole.wall_ms(), cpu_ms = whole.cpu_ms();
  if (!result.converged())
    throw MachineError("bench: the prediction at " + std::to_string(nodes) +
                       " nodes did not converge");
  Nodes reference = x;
  settings.tolerance_mm *= 0.01;
  const HessianFactor near = factor.anew(set.mesh, loads, x, threads);
  const MinimizeResult tight = minimize_with_refactorization(
      set.mesh, loads, energy, near, settings, reference, {.first = 12, .far = 0});
  const double error_mm = largest_distance(x, reference);
  const Json shown_ms = tight.converged() && error_mm <= target_mm ? Json(wall_ms) : Json();
  return {{"name", "tissue.static"},
          {"median", shown_ms},
          {"p95", shown_ms},
          {"unit", "ms"},
          {"cpu_median", cpu_ms},
          {"nodes", set.mesh.node_count},
          {"threads", threads},
          {"method", "condyle, from nothing"},
          {"build_ms", build_ms},
          {"factor_ms", factor_ms},
          {"solve_ms", wall_ms - build_ms - factor_ms},
          {"iterations", result.iterations},
          {"error_mm", error_mm},
          {"energy_error", (result.energy - tight.energy) / tight.energy},
          {"converged", tight.converged()}};
}

}  // namespace condyle
