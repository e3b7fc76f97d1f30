#include "tools/bench/baseline/line_search.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

constexpr double golden = 0.381966;

/// Position of the vertex of the parabola through three points; NaN where it has none.
double vertex(const LinePoint& a, const LinePoint& b, const LinePoint& c) {
  const double p = (b.t - a.t) * (b.value - c.value), q = (b.t - c.t) * (b.value - a.value);
  return b.t - ((b.t - a.t) * p - (b.t - c.t) * q) / (2 * (p - q));
}

struct Bracket {
  LinePoint low, middle, high;  // middle has the least value
  bool found = false;
};

/// Brent's method within a bracket.
LinePoint brent(const std::function<double(double)>& value, const Bracket& bracket,
                double tolerance, int evaluations) {
  double a = std::min(bracket.low.t, bracket.high.t), b = std::max(bracket.low.t, bracket.high.t);
  LinePoint x = bracket.middle, w = bracket.low, v = bracket.high;  // best, second, third
  if (v.value < w.value) std::swap(v, w);
  const double min_width = 1e-3 * tolerance * (b - a);
  double before_last = b - a, last = b - a;
  for (; evaluations > 0; --evaluations) {
    const double width = tolerance * std::abs(x.t) + min_width, middle = 0.5 * (a + b);
    if (std::abs(x.t - middle) <= 2 * width - 0.5 * (b - a)) break;
    double step = vertex(w, x, v) - x.t;
    const bool good = std::isfinite(step) && std::abs(step) < 0.5 * std::abs(before_last) &&
                      x.t + step > a && x.t + step < b;
    before_last = last;
    if (!good) {
      before_last = x.t < middle ? b - x.t : a - x.t;
      step = golden * before_last;
    } else if (x.t + step - a < 2 * width || b - x.t - step < 2 * width) {
      step = std::copysign(width, middle - x.t);
    }
    last = step;
    LinePoint u;
    u.t = x.t + (std::abs(step) >= width ? step : std::copysign(width, step));
    u.value = value(u.t);
    if (u.value <= x.value) {
      (u.t >= x.t ? a : b) = x.t;
      v = w;
      w = x;
      x = u;
    } else {
      (u.t < x.t ? a : b) = u.t;
      if (u.value <= w.value || w.t == x.t) {
        v = w;
        w = u;
      } else if (u.value <= v.value || v.t == x.t || v.t == w.t) {
        v = u;
      }
    }
  }
  return x;
}

}  // namespace

LinePoint search_by_parabolas(const std::function<double(double)>& value, const LinePoint& start,
                              const LineSettings& settings) {
  int left = settings.max_evaluations;
  const auto at = [&](double t) {
    --left;
    return LinePoint{t, value(t), 0};
  };
  Bracket bracket{start, at(std::min(settings.first_step, settings.greatest)), {}, false};
  double direction = 1;
  if (!(bracket.middle.value < start.value) && settings.both_sides) {
    const LinePoint other = at(-settings.first_step);
    if (!(other.value < start.value)) {
      bracket = {other, start, bracket.middle, true};
    } else {
      direction = -1;
      bracket.middle = other;
    }
  }
  // Too far: back towards the start.
  while (!bracket.found && !(bracket.middle.value < start.value) && left > 0) {
    bracket.high = bracket.middle;
    const double t = bracket.high.t;
    const double fit =
        -start.slope * t * t / (2 * (bracket.high.value - start.value - start.slope * t));
    bracket.middle = at(fit > 0 ? std::clamp(fit, 0.05 * t, 0.6 * t) : 0.2 * t);
    bracket.found = bracket.middle.value < start.value;
  }
  if (!bracket.found && !(bracket.middle.value < start.value)) return start;
  // Still decreasing: extrapolate by the parabola through the last three where it is valid.
  while (!bracket.found && left > 0) {
    const double t = bracket.middle.t, span = std::abs(t - bracket.low.t);
    if (t * direction >= settings.greatest) return bracket.middle;
    LinePoint next = at(direction * std::min(std::abs(t) + 1.618 * span, settings.greatest));
    if (!(next.value < bracket.middle.value)) {
      bracket.high = next;
      bracket.found = true;
      break;
    }
    const double fit = vertex(bracket.low, bracket.middle, next) * direction;
    const double reach = std::min(std::abs(next.t) + 20 * span, settings.greatest);
    bracket.low = bracket.middle;
    bracket.middle = next;
    if (fit > std::abs(next.t) && fit < reach && left > 0) {
      const LinePoint jump = at(direction * fit);
      if (jump.value < next.value) {
        bracket.low = next;
        bracket.middle = jump;
      } else {
        bracket.high = jump;
        bracket.found = true;
      }
    }
  }
  return bracket.found ? brent(value, bracket, settings.tolerance, left) : bracket.middle;
}

LinePoint search_by_slopes(const std::function<LinePoint(double)>& value_and_slope,
                           const LinePoint& start, const LineSettings& settings) {
  int left = settings.max_evaluations;
  LinePoint low = start, high, best = start;
  bool bracketed = false;
  int lows = 0, highs = 0;  // evaluations since the other end moved
  double next = std::min(settings.first_step, settings.greatest);
  while (left-- > 0) {
    const LinePoint here = value_and_slope(next);
    const bool finite = std::isfinite(here.value) && std::isfinite(here.slope);
    if (finite && here.value < best.value) best = here;
    const LinePoint before = low;
    if (!finite || here.slope > 0 || here.value > low.value) {
      high = here;
      if (!finite) high.slope = 0;  // no information: halve
      bracketed = true;
      ++highs;
      lows = 0;
    } else {
      low = here;
      ++lows;
      highs = 0;
      if (here.t >= settings.greatest) break;
    }
    if (!bracketed) {
      const double ahead = here.t + 1.618 * (here.t - before.t);
      const double secant = here.t - here.slope * (here.t - before.t) / (here.slope - before.slope);
      const bool good = secant > here.t && secant < here.t + 10 * (here.t - before.t);
      next = std::min(good ? secant : ahead, settings.greatest);
    } else {
      // The slope of an end that stays is halved repeatedly (Illinois).
      const double width = high.t - low.t;
      const double low_slope = std::ldexp(low.slope, -std::max(0, highs - 1));
      const double high_slope = std::ldexp(high.slope, -std::max(0, lows - 1));
      next = high.slope > 0 ? low.t - low_slope * width / (high_slope - low_slope)
                            : low.t + 0.5 * width;
      if (width <= settings.tolerance * high.t) break;
      const double margin = 0.01 * settings.tolerance * width;
      next = std::clamp(next, low.t + margin, high.t - margin);
    }
    if (best.t > 0 && std::abs(next - here.t) <= settings.tolerance * here.t &&
        std::abs(here.slope) <= 0.1 * std::abs(start.slope))
      break;
  }
  return best;
}

}  // namespace condyle
