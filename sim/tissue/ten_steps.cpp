#include "sim/tissue/ten_steps.h"

#include <algorithm>
#include <cmath>

#include "sim/tissue/model.h"

namespace condyle {

TenSteps ten_steps(const TissueModel& model, double opening_rad, int threads) {
  constexpr double degree = 0.01745329;
  constexpr double forward_mm = 1;
  TenSteps result;
  const TissueBudget budget{.threads = threads};
  TissueState open = rest_tissue(model);
  const int frames = std::max(1, static_cast<int>(std::ceil(opening_rad / degree)));
  for (int i = 1; i <= frames; ++i)
    open = follow(model, open, model.path.pose(opening_rad * i / frames), budget);
  result.X_CM = open.X_CM;
  const auto forward = [&](const TissueState& from, double mm) {
    Pose X_CM = result.X_CM;
    X_CM.t.y() -= mm;
    return follow(model, from, X_CM, budget);
  };
  TissueState once = forward(open, forward_mm), stepwise = open;
  for (int i = 1; i <= 10; ++i) stepwise = forward(stepwise, forward_mm * i / 10);
  result.of_frames_mm = largest_way(once.nodes, stepwise.nodes);
  once = settle(model, once, settled_mm, threads);
  stepwise = settle(model, stepwise, settled_mm, threads);
  result.difference_mm = largest_way(once.nodes, stepwise.nodes);
  result.moved_mm = largest_way(open.nodes, once.nodes);
  result.settled = once.converged && stepwise.converged;
  return result;
}

}  // namespace condyle
