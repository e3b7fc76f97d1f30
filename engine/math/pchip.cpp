#include "engine/math/pchip.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace condyle {
namespace {

/// Three-point end slope, kept from overshooting (SciPy's `_edge_case`).
double end_slope(double h0, double h1, double m0, double m1) {
  const double d = ((2 * h0 + h1) * m0 - h0 * m1) / (h0 + h1);
  if (d * m0 <= 0) return 0;
  if (m0 * m1 <= 0 && std::abs(d) > 3 * std::abs(m0)) return 3 * m0;
  return d;
}

}  // namespace

Pchip::Pchip(std::span<const double> x, std::span<const double> y)
    : x_(x.begin(), x.end()), y_(y.begin(), y.end()), slope_(x.size(), 0.0) {
  const std::size_t n = x_.size();
  assert(n >= 2 && y_.size() == n);
  assert(std::adjacent_find(x_.begin(), x_.end(), [](double a, double b) { return !(a < b); }) ==
         x_.end());
  std::vector<double> h(n - 1), m(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x_[i + 1] - x_[i];
    m[i] = (y_[i + 1] - y_[i]) / h[i];
  }
  if (n == 2) {
    slope_ = {m[0], m[0]};
    return;
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (m[i - 1] * m[i] <= 0) continue;
    const double w1 = 2 * h[i] + h[i - 1], w2 = h[i] + 2 * h[i - 1];
    slope_[i] = (w1 + w2) / (w1 / m[i - 1] + w2 / m[i]);
  }
  slope_.front() = end_slope(h[0], h[1], m[0], m[1]);
  slope_.back() = end_slope(h[n - 2], h[n - 3], m[n - 2], m[n - 3]);
}

std::size_t Pchip::interval(double x) const {
  const auto it = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  return static_cast<std::size_t>(it - x_.begin()) - 1;
}

double Pchip::operator()(double x) const {
  assert(!x_.empty());
  if (x <= x_.front()) return y_.front();
  if (x >= x_.back()) return y_.back();
  const std::size_t i = interval(x);
  const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h;
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * y_[i] + (t3 - 2 * t2 + t) * h * slope_[i] +
         (-2 * t3 + 3 * t2) * y_[i + 1] + (t3 - t2) * h * slope_[i + 1];
}

double Pchip::derivative(double x) const {
  assert(!x_.empty());
  if (x < x_.front() || x > x_.back()) return 0;
  const std::size_t i = interval(x);
  const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h, t2 = t * t;
  return ((6 * t2 - 6 * t) * (y_[i] - y_[i + 1])) / h + (3 * t2 - 4 * t + 1) * slope_[i] +
         (3 * t2 - 2 * t) * slope_[i + 1];
}

}  // namespace condyle
