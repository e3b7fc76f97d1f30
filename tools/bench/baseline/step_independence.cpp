#include "tools/bench/baseline/step_independence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/tissue/model.h"

namespace condyle {
namespace {

/// Tissue with the warm start of its next solve.
struct WarmTissue {
  TissueState state;
  TissueWarmStart warm;

  void solve(const TissueModel& model, const Pose& X_CM, int threads) {
    const std::array X_CB{Pose{}, X_CM};
    state = solve_tissue(model, state, X_CB, {.threads = threads}, warm);
  }
};

}  // namespace

StepIndependence step_independence(const TissueModel& model, double opening_rad, int threads) {
  constexpr double frame_rad = std::numbers::pi / 180;
  constexpr double forward_mm = 1;
  constexpr int steps = 10;
  StepIndependence result;
  WarmTissue open{rest_tissue(model), {}};
  const int frames = std::max(1, static_cast<int>(std::ceil(opening_rad / frame_rad)));
  for (int i = 1; i <= frames; ++i) {
    result.X_CM = model.opening.path->pose(opening_rad * i / frames);
    open.solve(model, result.X_CM, threads);
  }
  const auto forward = [&](double mm) {
    Pose X_CM = result.X_CM;
    X_CM.t.y() -= mm;
    return X_CM;
  };
  WarmTissue once = open, stepwise = open;
  once.solve(model, forward(forward_mm), threads);
  for (int i = 1; i <= steps; ++i) stepwise.solve(model, forward(forward_mm * i / steps), threads);
  result.of_frames_mm = largest_displacement(once.state.nodes, stepwise.state.nodes);
  const auto equilibrium = [&](const WarmTissue& from) {
    return solve_to_equilibrium(model, from.state, equilibrium_mm, threads, from.warm);
  };
  const TissueState of_one = equilibrium(once), of_ten = equilibrium(stepwise);
  result.difference_mm = largest_displacement(of_one.nodes, of_ten.nodes);
  result.moved_mm = largest_displacement(open.state.nodes, of_one.nodes);
  result.settled = of_one.converged && of_ten.converged;
  return result;
}

}  // namespace condyle
