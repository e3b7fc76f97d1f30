#include "tools/bench/tissue_warm.h"

#include <chrono>
#include <thread>

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "engine/tissue/async_preconditioner.h"
#include "engine/tissue/node_extrapolation.h"
#include "engine/tissue/refactorization.h"
#include "tools/bench/baseline/tissue_target.h"

namespace condyle {
namespace {

constexpr std::chrono::microseconds pace(8333);

/// How many frames, and how exactly errors are measured: large tissues get less of both.
struct WarmPlan {
  double from_deg = 10;
  int frames = 60, samples_every = 1;
  int budget = 40;             // iterations of a frame
  double reference_mm = 1e-7;  // tolerance of the answers that errors are measured against
  double begin_mm = 1e-3;      // and of the state in which the motion begins
  RefactorPolicy from_rest = {}, near = {.first = 12, .far = 0};
};
WarmPlan plan_for(int nodes) {
  if (nodes < 5000) return {};
  const bool huge = nodes > 30000;
  return {.from_deg = huge ? 2.0 : 5.0,
          .frames = huge ? 4 : 20,
          .samples_every = huge ? 4 : 5,
          .budget = huge ? 12 : 40,
          .reference_mm = huge ? 1e-3 : 1e-4,
          .begin_mm = huge ? 1e-2 : 1e-3,
          .from_rest = large_mesh_policy,
          .near = {.first = 20, .far = 0, .later = 20, .most = 20}};
}

/// The motion, frame by frame.
class FaceMotion {
 public:
  FaceMotion(const SyntheticSet& set, const WarmPlan& plan, int threads)
      : set_(set),
        plan_(plan),
        threads_(threads),
        x_(set.rest),
        rolling_(begin()),
        loads_(synthetic_loads(set, pose_at(-lead))),
        energy_(set.mesh, loads_, threads) {}

  static constexpr int lead =
      8;  // frames before the clock starts, so that warm starts are measured
  struct Frame {
    double wall_ms = 0, cpu_ms = 0, waited_ms = 0, between_ms = 0;
    MinimizeResult result;
  };
  Frame step(int frame) {
    Frame measured;
    const Stopwatch watch;
    loads_ = synthetic_loads(set_, pose_at(frame));
    rolling_.advance();
    measured.waited_ms = watch.wall_ms();
    const Nodes taken = carried(set_, x_, pose_at(frame - 1), pose_at(frame));
    Nodes next = taken;
    own_.extrapolate(next);
    MinimizeSettings settings;
    settings.tolerance_mm = 5e-3;
    settings.max_iterations = plan_.budget;
    settings.fresh = true;
    const auto solve = [&] { measured.result = minimize(energy_, rolling_.now(), settings, next); };
    solve();
    if (measured.result.status == MinimizeResult::Status::bad_start) {
      next = x_;
      solve();
    }
    measured.wall_ms = watch.wall_ms();
    measured.cpu_ms = watch.cpu_ms();

    const Stopwatch between;
    own_.add_frame(next, taken);
    x_.swap(next);
    Nodes ahead = carried(set_, x_, pose_at(frame), pose_at(frame + 1));
    own_.extrapolate(ahead);
    rolling_.begin(set_.mesh, loads_, std::move(ahead), threads_, nullptr);
    if (threads_ == 1) rolling_.finish();
    measured.between_ms = between.wall_ms();
    return measured;
  }
  const Nodes& nodes() const { return x_; }
  int lag() const { return AsyncPreconditioner::lag(rolling_.now()); }

  struct Error {
    double mm, energy;  // of the worst node; relative
  };
  Error error(int frame, const Nodes& nodes, double reached) const {
    Nodes reference = nodes;
    const HessianFactor fresh =
        first_->anew(set_.mesh, synthetic_loads(set_, pose_at(frame)), nodes, threads_);
    const double least = settle(frame, fresh, reference, plan_.reference_mm, plan_.near);
    return {largest_distance(nodes, reference), (reached - least) / least};
  }

 private:
  Pose pose_at(int frame) const {
    return synthetic_pose((plan_.from_deg + 0.5 * frame) * degree, Eigen::Vector3d::Zero());
  }
  double settle(int frame, const HessianFactor& factor, Nodes& nodes, double tolerance,
                const RefactorPolicy& schedule) const {
    MinimizeSettings tight;
    tight.tolerance_mm = tolerance;
    tight.max_step_mm = bench_step_mm;
    const MeshLoads loads = synthetic_loads(set_, pose_at(frame));
    SpringPrismEnergy energy(set_.mesh, loads, threads_);
    const auto result =
        minimize_with_refactorization(set_.mesh, loads, energy, factor, tight, nodes, schedule);
    if (!result.converged()) throw MachineError("bench: the reference did not converge");
    return result.energy;
  }
  /// Settles the tissue before the first frame; gives the factor there.
  std::shared_ptr<const HessianFactor> begin() {
    const MeshLoads rest_loads = synthetic_loads(set_, Pose{});
    first_ = std::make_shared<const HessianFactor>(set_.mesh, rest_loads, set_.sheets, set_.rest,
                                                   threads_);
    constexpr int before = -lead - 1;
    settle(before, *first_, x_, plan_.begin_mm, plan_.from_rest);
    return std::make_shared<const HessianFactor>(
        first_->anew(set_.mesh, synthetic_loads(set_, pose_at(before)), x_, threads_));
  }

  const SyntheticSet& set_;
  const WarmPlan plan_;
  const int threads_;
  Nodes x_;
  std::shared_ptr<const HessianFactor> first_;  // at rest
  AsyncPreconditioner rolling_;
  MeshLoads loads_;
  SpringPrismEnergy energy_;
  NodeExtrapolator own_;
};

}  // namespace

nlohmann::ordered_json warm_frames(const SyntheticSet& set, int threads, const char* name) {
  const WarmPlan plan = plan_for(set.mesh.node_count);
  FaceMotion motion(set, plan, threads);
  struct Sample {
    int frame;
    Nodes nodes;
    double energy;
  };
  std::vector<Sample> samples;
  std::vector<double> wall, cpu, waited, between, iterations;
  int cut_short = 0;
  double residual = 0;
  auto next_frame = std::chrono::steady_clock::now();
  for (int frame = -FaceMotion::lead; frame < plan.frames; ++frame) {
    std::this_thread::sleep_until(next_frame);
    next_frame = std::max(next_frame + pace, std::chrono::steady_clock::now());
    const FaceMotion::Frame measured = motion.step(frame);
    if (frame < 0) continue;
    wall.push_back(measured.wall_ms);
    cpu.push_back(measured.cpu_ms);
    waited.push_back(measured.waited_ms);
    between.push_back(measured.between_ms);
    iterations.push_back(measured.result.iterations);
    cut_short += !measured.result.converged();
    residual = std::max(residual, measured.result.residual);
    if (frame % plan.samples_every == plan.samples_every - 1)
      samples.push_back({frame, motion.nodes(), measured.result.energy});
  }
  double worst_mm = 0, worst_energy = 0;
  for (const auto& [frame, nodes, reached] : samples) {
    const FaceMotion::Error error = motion.error(frame, nodes, reached);
    worst_mm = std::max(worst_mm, error.mm);
    worst_energy = std::max(worst_energy, error.energy);
  }
  auto json = timing_json({name, set.mesh.node_count, threads, "condyle"}, quantiles(wall),
                          quantiles(cpu).median, worst_mm);
  constexpr double most_mm = 0.1;
  if (worst_mm > most_mm) json["median"] = json["p95"] = nullptr;
  json["energy_error"] = worst_energy;
  json["cpu_p95"] = quantiles(cpu).p95;
  json["frames"] = plan.frames;
  json["iterations"] = quantiles(iterations).median;
  json["iterations_p95"] = quantiles(iterations).p95;
  json["frames_cut_short"] = cut_short;
  json["residual_N"] = residual;
  json["factor_lag_frames"] = motion.lag();
  json["waited_p95_ms"] = quantiles(waited).p95;
  if (threads == 1) json["factor_between_frames_ms"] = quantiles(between).median;
  return json;
}

}  // namespace condyle
