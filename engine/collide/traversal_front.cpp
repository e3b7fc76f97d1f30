#include "engine/collide/traversal_front.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace condyle {
namespace {

constexpr double slow_mm = 0.05;       // per query; faster bodies reach most ends
constexpr double max_unused_mm = 0.1;  // from the last query that used the front
// Single precision holds bounds up to the sum of both to 1e-5 mm.
constexpr double max_travel_mm = 40, max_gap_mm = 200;
constexpr double rounding_mm = 2e-5;
// Ends are divided and never joined: with so many more than at first, a query begins anew.
constexpr std::size_t max_growth = 2, extra_ends = 1000;

/// At least the displacement of any point in the box, as its body moves between two poses.
double displacement_mm(const BoxPair& box, const Eigen::Isometry3d& X,
                       const Eigen::Isometry3d& to) {
  const Eigen::Vector3d center(box.center[0][0], box.center[1][0], box.center[2][0]);
  const double radius = std::sqrt(static_cast<double>(box.squared_radius(0)));
  // The difference of two rotations stretches no vector more than this.
  const double turn = (to.linear() - X.linear()).norm() / std::sqrt(2);
  constexpr double rounding = 1e-6;
  return (to * center - X * center).norm() + turn * radius * (1 + rounding) + 1e-9;
}

}  // namespace

bool TraversalFront::begin(const std::vector<BoxPair>& a, const std::vector<BoxPair>& b,
                           const Eigen::Isometry3d& X) {
  const bool known = a_ == a.data() && b_ == b.data();
  const double step_mm = known ? displacement_mm(b.front(), X_, X) : 0;
  a_ = a.data();
  b_ = b.data();
  X_ = X;
  if (!known) last_.clear();
  travelled_mm_ += step_mm;
  unused_mm_ += step_mm;
  if (!known || !(step_mm < slow_mm)) return false;
  at_roots_ = last_.empty() || !(unused_mm_ < max_unused_mm) || !(travelled_mm_ < max_travel_mm) ||
              last_.size() > max_growth * first_count_ + extra_ends;
  if (at_roots_) travelled_mm_ = 0;
  unused_mm_ = 0;
  next_.clear();
  return true;
}

void TraversalFront::add(int a, int b, double gap_mm) {
  next_.push_back(
      {a, b, static_cast<float>(std::min(gap_mm, max_gap_mm) + travelled_mm_ - rounding_mm)});
}

void TraversalFront::finish() {
  std::swap(last_, next_);
  if (at_roots_) first_count_ = last_.size();
}

}  // namespace condyle
