#pragma once

#include <span>
#include <vector>

namespace condyle {

/// Monotone cubic interpolation (Fritsch-Carlson; the same slopes as SciPy's PchipInterpolator).
/// Constant beyond the ends.
class Pchip {
 public:
  Pchip() = default;
  /// x strictly increasing, the same length as y, at least 2.
  Pchip(std::span<const double> x, std::span<const double> y);
  double operator()(double x) const;
  double derivative(double x) const;

 private:
  std::size_t interval(double x) const;
  std::vector<double> x_, y_, slope_;
};

}  // namespace condyle
