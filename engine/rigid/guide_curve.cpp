#include "engine/rigid/guide_curve.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int marks_per_span = 8;
constexpr double min_span_mm = 1e-6;

}  // namespace

GuideCurve::GuideCurve(std::vector<Vector3d> points) : points_(std::move(points)) {
  if (points_.size() < 2) throw InputError("a guide needs at least two points");
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    length_.push_back((points_[i + 1] - points_[i]).norm());
    if (!(length_.back() > min_span_mm) || !std::isfinite(length_.back()))
      throw InputError("points " + std::to_string(i) + " and " + std::to_string(i + 1) +
                       " of a guide coincide or are not finite");
  }
  const std::size_t last = points_.size() - 1;
  const auto chord = [&](std::size_t i) {
    return Vector3d((points_[i + 1] - points_[i]) / length_[i]);
  };
  slopes_.resize(points_.size());
  for (std::size_t i = 1; i < last; ++i)
    slopes_[i] =
        (length_[i] * chord(i - 1) + length_[i - 1] * chord(i)) / (length_[i - 1] + length_[i]);
  slopes_[0] = last > 1 ? Vector3d(2 * chord(0) - slopes_[1]) : chord(0);
  slopes_[last] = last > 1 ? Vector3d(2 * chord(last - 1) - slopes_[last - 1]) : chord(0);
  Vector3d slope;
  for (std::size_t k = 0; k <= last * marks_per_span; ++k) {
    marks_.emplace_back();
    at(static_cast<double>(k) / marks_per_span, marks_.back(), slope);
  }
}

void GuideCurve::at(double s, Vector3d& point, Vector3d& slope) const {
  const std::size_t i = std::min(static_cast<std::size_t>(s), length_.size() - 1);
  const double u = s - static_cast<double>(i), h = length_[i];
  const Vector3d rise = points_[i + 1] - points_[i];
  const Vector3d p = h * slopes_[i], q = h * slopes_[i + 1];
  // Cubic Hermite interpolation.
  const Vector3d b = 3 * rise - 2 * p - q, c = p + q - 2 * rise;
  point = points_[i] + u * (p + u * (b + u * c));
  slope = p + u * (2 * b + 3 * u * c);
}

GuideCurve::Place GuideCurve::nearest(const Vector3d& p,
                                      const std::optional<Vector3d>& sideways) const {
  assert(!sideways || std::abs(sideways->norm() - 1) < 1e-6);
  const auto across = [&](const Vector3d& v) {
    return sideways ? Vector3d(v - v.dot(*sideways) * *sideways) : v;
  };
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < marks_.size(); ++k) {
    const double d = across(p - marks_[k]).squaredNorm();
    if (d < least) {
      least = d;
      best = k;
    }
  }
  // Between the adjacent marks the derivative of the distance changes its sign: bisection, then
  // secant.
  const auto end = static_cast<double>(length_.size());
  double low = std::max(0.0, (static_cast<double>(best) - 1) / marks_per_span);
  double high = std::min(end, (static_cast<double>(best) + 1) / marks_per_span);
  Place place;
  Vector3d slope;
  const auto ahead = [&](double s) {
    at(s, place.point, slope);
    return across(p - place.point).dot(across(slope));
  };
  double f_low = ahead(low), f_high = ahead(high), s = low;
  if (f_low <= 0) {
    s = low;
  } else if (f_high >= 0) {
    s = high;
  } else {
    for (int k = 0; k < 60 && high - low > 1e-14 * end; ++k) {
      s = k % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * f_low / (f_low - f_high);
      const double f = ahead(s);
      if (f > 0) {
        low = s;
        f_low = f;
      } else {
        high = s;
        f_high = f;
      }
      if (f == 0) break;
    }
  }
  ahead(s);
  place.along = slope.normalized();
  Vector3d point, at_end;
  at(0, point, at_end);
  place.from_start_mm = (p - point).dot(at_end.normalized());
  at(end, point, at_end);
  place.from_end_mm = (point - p).dot(at_end.normalized());
  return place;
}

}  // namespace condyle
