#include "engine/minimize/minimize.h"

#include "engine/minimize/minimizer_parts.h"

namespace condyle {

// Preconditioned Polak-Ribiere with a parabolic line search: where every squared length is
// quadratic along a direction and every volume cubic, one step with the exact slope and curvature
// is nearly always taken as it is. The first step of a fresh preconditioner is of full length, if
// that leaves the line nearly flat; else the line goes on where its slopes say. A renewed
// preconditioner begins anew, downhill.
MinimizeResult minimize(Objective& objective, const Preconditioner& given,
                        const MinimizeSettings& settings, Points& x) {
  using namespace minimizers;
  using Status = MinimizeResult::Status;
  MinimizeResult result;
  Counted counted(objective, settings, result);
  Points g, g_new, z, d, trial(x.size());

  // The way that is left, by the preconditioner. Iterations that shorten it by a factor each leave
  // the sum of a geometric series; before the first nothing is known of that factor.
  constexpr double flat = 0.1;  // of the slope at the start of a step of full length, if it serves
  constexpr double unknown_fraction = 0.3, least_contraction = 0.95;
  const Preconditioner* preconditioner = &given;
  double gz = 0, way = 0, shortest = 0;
  double slope = 0, length = 0;  // along d; of its longest
  // The way along z is longer than it says where the preconditioner is stiffer than the objective,
  // and shorter where it is softer: at most to `least`, as other parts may be as stiff.
  const auto stretch = [&](double least) {
    const auto curvature = objective.curvature(x, z);
    return curvature.gauss_newton > 0 ? std::max(least, gz / curvature.gauss_newton) : 1.0;
  };
  // A fresh one is not five times too stiff: far below, no look is needed.
  const double far_below = settings.fresh ? 0.2 : 0.0, softest = settings.fresh ? 0.5 : 1.0;
  const auto arrived = [&](double enough, double least) {
    return way < far_below * enough || (way * least < enough && way * stretch(least) < enough);
  };
  const auto downhill = [&] {
    for (std::size_t i = 0; i < x.size(); ++i) d[i] = -z[i];
    slope = -gz;
    length = way;
  };
  const auto begin = [&] {
    preconditioner->solve(g, z);
    gz = dot(g, z);
    if (!std::isfinite(gz)) return false;
    way = shortest = largest_norm(z);
    d.resize(x.size());
    downhill();
    if (arrived(unknown_fraction * settings.tolerance_mm, 1)) result.status = Status::converged;
    return true;
  };

  double f = counted.value_and_gradient(x, g);
  if (!std::isfinite(f) || !begin()) {
    result.status = Status::bad_start;
    result.energy = f;
    result.residual = largest_norm(g);
    return result;
  }
  for (; !result.converged() && result.iterations < settings.max_iterations && !counted.spent();
       ++result.iterations) {
    const double longest = settings.max_step_mm / length;
    double step = 1;
    bool predicted = settings.fresh && result.iterations == 0 && step < longest;
    if (!predicted) {
      const auto curvature = objective.curvature(x, d);
      const double bend =
          curvature.exact > 0.1 * curvature.gauss_newton ? curvature.exact : curvature.gauss_newton;
      if (!(bend > 0)) {
        result.status = Status::stalled;
        break;
      }
      step = std::min(-slope / bend, longest);
    }

    double f_new = 0;
    bool accepted = false;
    for (int attempt = 0; attempt < 30 && !accepted && !counted.spent(); ++attempt) {
      step_along(x, step, d, trial);
      f_new = counted.value_and_gradient(trial, g_new);
      if (predicted && std::isfinite(f_new)) {
        predicted = false;
        const double slope_new = dot(g_new, d);
        if (slope_new > slope && std::abs(slope_new) > flat * -slope) {
          step = std::min(slope / (slope - slope_new), longest);
          continue;
        }
      }
      // Near the minimum the energies differ by less than their rounding; then the slope decides.
      const double rounding = 1e-13 * std::abs(f);
      accepted = f_new <= f + 1e-4 * step * slope ||
                 (std::abs(f_new - f) <= rounding && std::abs(dot(g_new, d)) <= 0.9 * -slope);
      if (!accepted) {
        const double fit = f_new - f - step * slope;  // parabola through f, slope and f_new
        const double parabolic = fit > 0 ? -slope * step * step / (2 * fit) : 0.3 * step;
        step = std::isfinite(f_new) ? std::clamp(parabolic, 0.1 * step, 0.6 * step) : 0.75 * step;
      }
    }
    if (!accepted) {  // as low as the arithmetic goes
      if (way < settings.tolerance_mm)
        result.status = Status::converged;
      else if (!counted.spent())
        result.status = Status::stalled;
      break;
    }

    x.swap(trial);
    f = f_new;
    if (settings.renew && result.iterations + 1 < settings.max_iterations && !counted.spent()) {
      MinimizeResult done = result;
      ++done.iterations;
      if (const Preconditioner* other = settings.renew(x, done)) {
        preconditioner = other;
        g.swap(g_new);
        if (begin()) continue;
        result = done;
        result.status = Status::stalled;
        break;
      }
    }
    preconditioner->solve(g_new, z);
    const double gz_new = dot(g_new, z);
    const double beta = std::max(0.0, (gz_new - dot(g, z)) / gz);
    g.swap(g_new);
    gz = gz_new;
    way = largest_norm(z);
    const double contraction = std::min(way / shortest, least_contraction);
    shortest = std::min(shortest, way);
    if (arrived(settings.tolerance_mm * (1 - contraction), softest)) {
      ++result.iterations;
      result.status = Status::converged;
      break;
    }
    for (std::size_t i = 0; i < x.size(); ++i) d[i] = beta * d[i] - z[i];
    slope = dot(g, d);
    length = largest_norm(d);
    if (slope >= 0) downhill();
  }
  result.energy = f;
  result.residual = largest_norm(g);
  result.bytes = bytes_of(g, g_new, z, d, trial) + given.bytes();
  return result;
}

}  // namespace condyle
