#pragma once

#include <span>
#include <vector>

namespace condyle {

/// A monotone cubic curve as an evenly spaced table: fast enough to evaluate at every sample.
class Lookup {
 public:
  Lookup(std::span<const double> x, std::span<const double> y);
  Lookup(const std::vector<double>& x, const std::vector<double>& y)
      : Lookup(std::span<const double>(x), std::span<const double>(y)) {}

  /// Linear between entries, constant beyond the ends.
  double operator()(double x) const {
    const double g = (x - low_) * scale_;
    if (!(g > 0)) return values_.front();
    const auto cell = static_cast<std::size_t>(g);
    if (cell + 1 >= values_.size()) return values_.back();
    const double t = g - static_cast<double>(cell);
    return values_[cell] + t * (values_[cell + 1] - values_[cell]);
  }

 private:
  double low_, scale_;
  std::vector<double> values_;
};

}  // namespace condyle
