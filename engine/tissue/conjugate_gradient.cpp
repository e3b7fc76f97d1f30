#include "engine/tissue/conjugate_gradient.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

double dot(const Nodes& a, const Nodes& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

double largest_norm(const Nodes& a) {
  double largest = 0;
  for (const auto& v : a) largest = std::max(largest, v.squaredNorm());
  return std::sqrt(largest);
}

}  // namespace

MinimizeResult minimize(const SpringPrismNet& net, const NetLoads& loads,
                        const HessianFactor& factor, const MinimizeSettings& settings, Nodes& x) {
  SpringPrismEnergy energy(net, loads, settings.threads);
  MinimizeResult result;
  Nodes g, g_new, z, z_new, d, trial(x.size());

  double f = energy.value_and_gradient(x, g);
  result.evaluations = 1;
  factor.solve(g, z);
  double gz = dot(g, z);
  d.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) d[i] = -z[i];

  if (largest_norm(z) < 0.05 * settings.tolerance_mm) result.converged = true;
  for (; !result.converged && result.iterations < settings.max_iterations; ++result.iterations) {
    double slope = dot(g, d);
    if (slope >= 0) {
      for (std::size_t i = 0; i < x.size(); ++i) d[i] = -z[i];
      slope = -gz;
    }
    // Parabolic line search: the minimum of the parabola with the exact slope and curvature.
    const auto curvature = energy.curvature(x, d);
    const double bend =
        curvature.exact > 0.1 * curvature.gauss_newton ? curvature.exact : curvature.gauss_newton;
    if (!(bend > 0)) break;
    double step = -slope / bend;
    const double reach = largest_norm(d);
    step = std::min(step, settings.max_step_mm / reach);

    double f_new = 0;
    bool accepted = false;
    for (int attempt = 0; attempt < 30 && !accepted; ++attempt) {
      for (std::size_t i = 0; i < x.size(); ++i) trial[i] = x[i] + step * d[i];
      f_new = energy.value_and_gradient(trial, g_new);
      ++result.evaluations;
      // Near the minimum the energies differ by less than their rounding; then the slope decides.
      const double rounding = 1e-13 * std::abs(f);
      accepted = f_new <= f + 1e-4 * step * slope ||
                 (std::abs(f_new - f) <= rounding && std::abs(dot(g_new, d)) <= 0.9 * -slope);
      if (!accepted) {
        const double fit = f_new - f - step * slope;  // parabola through f, slope and f_new
        const double parabolic =
            std::isfinite(f_new) && fit > 0 ? -slope * step * step / (2 * fit) : 0.3 * step;
        step = std::clamp(parabolic, 0.1 * step, 0.6 * step);
      }
    }
    if (!accepted) {  // as low as the arithmetic goes
      result.converged = largest_norm(z) < settings.tolerance_mm;
      break;
    }

    x.swap(trial);
    f = f_new;
    factor.solve(g_new, z_new);
    double change = 0;
    for (std::size_t i = 0; i < x.size(); ++i) change += z_new[i].dot(g_new[i] - g[i]);
    const double beta = std::max(0.0, change / gz);
    g.swap(g_new);
    z.swap(z_new);
    gz = dot(g, z);
    const double moved = step * reach;
    for (std::size_t i = 0; i < x.size(); ++i) d[i] = beta * d[i] - z[i];
    if (moved < settings.tolerance_mm && largest_norm(z) < settings.tolerance_mm) {
      ++result.iterations;
      result.converged = true;
      break;
    }
  }
  result.energy = f;
  result.residual = largest_norm(g);
  return result;
}

}  // namespace condyle
