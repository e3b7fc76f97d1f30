#include "tools/bench/baseline/methods.h"

namespace condyle::minimizers {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MinimizeResult quasi_newton(Objective& objective, const BaselineSettings& settings, Points& x) {
  MinimizeResult result;
  Counted counted(objective, settings, result);
  const Index n = static_cast<Index>(3 * x.size());
  Points trial(x.size()), g_points, g_new_points, d_points(x.size());
  double f = counted.value_and_gradient(x, g_points);
  result.energy = f;
  result.residual = largest_norm(g_points);
  if (!std::isfinite(f) || !std::isfinite(result.residual)) {
    result.status = MinimizeResult::Status::bad_start;
    return result;
  }
  g_new_points.resize(x.size());
  MatrixXd inverse = MatrixXd::Identity(n, n);  // lower half; of the second derivatives
  VectorXd y(n), Hy(n);
  Map<VectorXd> d(d_points.front().data(), n);
  result.bytes = static_cast<std::size_t>(inverse.size() + y.size() + Hy.size()) * sizeof(double) +
                 bytes_of(trial, g_points, g_new_points, d_points);

  bool fresh = true;  // the inverse is still a multiple of one
  double first_reach = 0.1 * settings.max_step_mm;
  while (result.residual > 0 && result.iterations < settings.max_iterations && !counted.spent()) {
    ++result.iterations;
    Map<VectorXd> g(g_points.front().data(), n);
    d.noalias() = -(inverse.selfadjointView<Eigen::Lower>() * g);
    double slope = g.dot(d);
    if (!(slope < 0)) {  // rounding has spoilt the inverse
      inverse.setIdentity();
      fresh = true;
      d = -g;
      slope = -g.squaredNorm();
    }
    const double reach = largest_norm(d_points);
    double step = fresh ? first_reach / reach : 1.0;
    step = std::min(step, settings.max_step_mm / reach);

    double f_new = 0;
    bool accepted = false;
    for (int attempt = 0; attempt < 30 && !accepted && !counted.spent(); ++attempt) {
      step_along(x, step, d_points, trial);
      f_new = counted.value_and_gradient(trial, g_new_points);
      accepted = f_new <= f + 1e-4 * step * slope;
      if (!accepted) {
        const double fit = f_new - f - step * slope;
        const double parabolic =
            std::isfinite(f_new) && fit > 0 ? -slope * step * step / (2 * fit) : 0.3 * step;
        step = std::clamp(parabolic, 0.1 * step, 0.6 * step);
      }
    }
    if (!accepted) {
      if (counted.spent()) break;
      if (fresh) {
        result.status = MinimizeResult::Status::stalled;
        break;
      }
      inverse.setIdentity();
      fresh = true;
      first_reach = settings.tolerance_mm;
      continue;
    }

    // BFGS: H += (1 + y H y / s y) s s / s y - (s Hy + Hy s) / s y, with s the step.
    y = Map<VectorXd>(g_new_points.front().data(), n) - g;
    d *= step;  // now s
    const double sy = d.dot(y);
    if (sy > 1e-12 * d.norm() * y.norm()) {
      if (fresh) inverse *= sy / y.squaredNorm();
      fresh = false;
      Hy.noalias() = inverse.selfadjointView<Eigen::Lower>() * y;
      // (s u + u s) with u = (1 + yHy/sy) s / (2 sy) - Hy / sy
      const double yHy = y.dot(Hy);
      y = ((1 + yHy / sy) / (2 * sy)) * d - Hy / sy;
      inverse.selfadjointView<Eigen::Lower>().rankUpdate(d, y);
    }
    x.swap(trial);
    g_points.swap(g_new_points);
    const double before = f;
    f = f_new;
    result.residual = largest_norm(g_points);
    if (settled(settings, step * reach, before, f)) {
      result.status = MinimizeResult::Status::converged;
      break;
    }
  }
  if (result.residual == 0) result.status = MinimizeResult::Status::converged;
  result.energy = f;
  return result;
}

}  // namespace condyle::minimizers
