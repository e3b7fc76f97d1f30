#include "tools/bench/baseline/line_search.h"
#include "tools/bench/baseline/methods.h"

namespace condyle::minimizers {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MinimizeResult powell(Objective& objective, const BaselineSettings& settings, Points& x) {
  MinimizeResult result;
  Counted counted(objective, settings, result);
  const Index n = static_cast<Index>(3 * x.size());
  Map<VectorXd> at(x.front().data(), n);
  Points trial_points(x.size());
  Map<VectorXd> trial(trial_points.front().data(), n);
  double f = counted.value(x);
  result.energy = f;
  if (!std::isfinite(f)) {
    result.status = MinimizeResult::Status::bad_start;
    return result;
  }
  MatrixXd direction = MatrixXd::Identity(n, n);
  VectorXd reach = VectorXd::Constant(n, 0.1);  // first trial step along each direction
  VectorXd before = at, total_step(n);
  result.bytes = static_cast<std::size_t>(direction.size() + reach.size() + before.size() +
                                          total_step.size()) *
                     sizeof(double) +
                 bytes_of(trial_points);

  // Moves to the minimum along `d`; true if that is lower.
  const auto along = [&](const auto& d, double& look) {
    LineSettings line;
    line.first_step = look;
    line.tolerance = settings.line_tolerance;
    line.both_sides = true;
    line.max_evaluations = std::min(60, settings.max_evaluations - result.evaluations);
    const LinePoint found = search_by_parabolas(
        [&](double t) {
          trial = at + t * d;
          return counted.value(trial_points);
        },
        {0, f, 0}, line);
    look = std::max(std::abs(found.t), 0.1 * look);
    if (!(found.value < f)) return false;
    at += found.t * d;
    f = found.value;
    return true;
  };

  const double floor = 0.01 * settings.tolerance_mm;  // resolution of the line searches
  while (result.iterations < settings.max_iterations && !counted.spent()) {
    ++result.iterations;
    before = at;
    const double f_before = f;
    double biggest = 0;
    Index biggest_at = 0;
    for (Index i = 0; i < n && !counted.spent(); ++i) {
      const double f_here = f;
      reach[i] = std::max(reach[i], floor);
      along(direction.col(i), reach[i]);
      if (f_here - f > biggest) {
        biggest = f_here - f;
        biggest_at = i;
      }
    }
    total_step = at - before;
    double moved = 0;
    for (Index i = 0; i < n; i += 3) moved = std::max(moved, total_step.segment<3>(i).norm());
    if (settled(settings, moved, f_before, f)) {
      result.status = MinimizeResult::Status::converged;
      break;
    }
    if (counted.spent()) break;
    // Powell's rule: the total step takes the place of the direction of the greatest fall,
    // unless that would make the directions dependent.
    trial = at + total_step;
    const double f_on = counted.value(trial_points);
    if (f_on >= f_before) continue;
    const double gain = f_before - f - biggest;
    if (2 * (f_before - 2 * f + f_on) * gain * gain >=
        biggest * (f_before - f_on) * (f_before - f_on))
      continue;
    const double length = total_step.norm();
    double look = length;
    total_step /= length;
    along(total_step, look);
    direction.col(biggest_at) = direction.col(n - 1);
    reach[biggest_at] = reach[n - 1];
    direction.col(n - 1) = total_step;
    reach[n - 1] = look;
  }
  result.energy = f;
  Points g;
  objective.value_and_gradient(x, g);  // only for the residual
  result.residual = largest_norm(g);
  return result;
}

}  // namespace condyle::minimizers
