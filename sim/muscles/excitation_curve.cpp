#include "sim/muscles/excitation_curve.h"

#include <algorithm>
#include <utility>

#include "engine/math/pchip.h"

namespace condyle {

ExcitationCurve::ExcitationCurve(std::vector<double> times, std::vector<double> values,
                                 Interpolation interpolation)
    : interpolation_(interpolation),
      times_(std::move(times)),
      values_(std::move(values)),
      slopes_(times_.size(), 0.0) {
  const std::size_t n = times_.size();
  if (interpolation == Interpolation::cubic)
    for (std::size_t i = 1; i + 1 < n; ++i)
      slopes_[i] = (values_[i + 1] - values_[i - 1]) / (times_[i + 1] - times_[i - 1]);
  if (interpolation == Interpolation::smooth && n > 1) {
    const Pchip monotone(times_, values_);
    for (std::size_t i = 0; i < n; ++i) slopes_[i] = monotone.derivative(times_[i]);
  }
}

double ExcitationCurve::operator()(double time_s) const {
  constexpr double same_s = 1e-9;  // tolerance for rounded times of steps
  if (interpolation_ == Interpolation::step) time_s += same_s;
  if (time_s <= times_.front()) return values_.front();
  if (time_s >= times_.back()) return values_.back();
  const auto after = std::upper_bound(times_.begin(), times_.end(), time_s);
  const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
  if (interpolation_ == Interpolation::step) return values_[i];
  const double h = times_[i + 1] - times_[i], u = (time_s - times_[i]) / h, w = 1 - u;
  if (interpolation_ == Interpolation::linear) return w * values_[i] + u * values_[i + 1];
  return w * w * (1 + 2 * u) * values_[i] + u * w * w * h * slopes_[i] +
         u * u * (1 + 2 * w) * values_[i + 1] - u * u * w * h * slopes_[i + 1];
}

}  // namespace condyle
