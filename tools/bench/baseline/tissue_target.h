#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "engine/tissue/hessian_factor.h"
#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {

/// The minimisation for every method: the same energy and start, and the converged result as the
/// reference for errors.
struct TissueTarget {
  SyntheticSet set;
  MeshLoads rest_loads = {}, loads = {};  // the lower bone at rest; moved
  Nodes converged = {};
  double converged_energy = 0;
  std::shared_ptr<const ElementBatches> batches = {};  // of the mesh
  Nodes begun = {};                                    // where solves start; at rest if empty

  const Nodes& start() const { return begun.empty() ? set.rest : begun; }
};
/// The set as it is, with its lower bone at the pose. throws: MachineError when it does not
/// converge.
TissueTarget make_target(SyntheticSet set, const Pose& lower_bone);

/// The movement of the benchmarks: opened by 5 degrees, 2 mm forward and 2 mm down.
Pose bench_movement();

/// Largest displacement of a node in one iteration: from rest directly to the present bones.
constexpr double bench_step_mm = 30;

/// Start of a cold solve: the tissue solved once with the lower bone opened, and the factor there.
/// Computed in the setup of a patient, as the simulator does along the path of opening.
struct StoredOpening {
  StoredOpening(const TissueTarget& target, const HessianFactor& at_rest, int threads);
  static constexpr double opened_rad = 0.1;
  Nodes nodes;
  HessianFactor factor;
  /// The part of the displacement to `nodes` that corresponds to the opening of `lower_bone`.
  Nodes start(const TissueTarget& target, const Pose& lower_bone) const;
};

double largest_distance(const Nodes& a, const Nodes& b);  // mm, of any node

/// Criterion of a solution: error of the worst node and of the energy (relative).
constexpr double target_mm = 0.01, target_energy = 1e-6;

struct Race {
  double tolerance = 0;  // the loosest of the ladder that meets the target with its own stop test
  bool met = false;
  double median_ms = 0, p95_ms = 0, cpu_ms = 0;  // wall time; processor time (median)
  double error_mm = 0, energy_error = 0;
};
/// `attempt` solves from x with a tolerance, leaves its answer in x and returns the energy there.
/// Ladder: 1e-1 down to 1e-9 by half decades. One run for each rung, then `repeats` timed.
Race race(const TissueTarget& target, int repeats,
          const std::function<double(double tolerance, Nodes& x)>& attempt);

struct Quantiles {
  double median = 0, p95 = 0;
};
Quantiles quantiles(std::vector<double> values);

/// Wall and processor time since construction, ms.
class Stopwatch {
 public:
  Stopwatch();
  double wall_ms() const;
  double cpu_ms() const;

 private:
  double wall_, cpu_;
};

struct TimingLine {
  const char* name;
  int nodes, threads;
  std::string method;
};
/// A row of a benchmark's results; times in ms.
nlohmann::ordered_json timing_json(const TimingLine& line, const Quantiles& times, double cpu_ms,
                                   double error_mm);

/// {"processor", "cores"}: the machine of the figures.
nlohmann::ordered_json machine_json();

}  // namespace condyle
