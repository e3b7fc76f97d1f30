#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/minimize/minimize.h"

/// Parts that minimisers have in common.
namespace condyle::minimizers {

inline double dot(const Points& a, const Points& b) {
  assert(a.size() == b.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // of each axis: three sums at once
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].cwiseProduct(b[i]);
  return sum.sum();
}

inline double largest_norm(const Points& a) {
  double largest = 0;
  for (const auto& v : a) largest = std::max(largest, v.squaredNorm());
  return std::sqrt(largest);
}

/// to = x + t d
inline void step_along(const Points& x, double t, const Points& d, Points& to) {
  assert(d.size() == x.size() && to.size() == x.size());
  for (std::size_t i = 0; i < x.size(); ++i) to[i] = x[i] + t * d[i];
}

template <class... P>
std::size_t bytes_of(const P&... points) {
  return ((points.capacity() * sizeof(Eigen::Vector3d)) + ... + 0);
}

/// An objective that counts, and says when the budget is spent.
class Counted {
 public:
  Counted(Objective& objective, const MinimizeSettings& settings, MinimizeResult& result)
      : objective_(objective), settings_(settings), result_(result) {}

  double value(const Points& x) {
    ++result_.evaluations;
    return objective_.value(x);
  }
  double value_and_gradient(const Points& x, Points& gradient) {
    ++result_.evaluations;
    ++result_.gradients;
    return objective_.value_and_gradient(x, gradient);
  }
  bool spent() const { return result_.evaluations >= settings_.max_evaluations; }

 private:
  Objective& objective_;
  const MinimizeSettings& settings_;
  MinimizeResult& result_;
};

}  // namespace condyle::minimizers
