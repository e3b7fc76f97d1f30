// The quick bound of two boxes' gap is never above it, wherever they lie, and near it where they
// face each other.
#include "engine/collide/box_bound.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct TurnedBox {
  Vector3d center, half;
  Matrix3d axes;
  Vector3d nearest(const Vector3d& p) const {
    const Vector3d inside = (axes.transpose() * (p - center)).cwiseMin(half).cwiseMax(-half);
    return center + axes * inside;
  }
  double reach() const { return center.norm() + half.norm(); }
  BoxBound bound() const { return {center, half, axes, -1}; }
};

/// Boxes are convex: going to and fro between nearest points ends at the gap, from above.
double gap(const TurnedBox& a, const TurnedBox& b, const Matrix3d& R, const Vector3d& t) {
  Vector3d p = a.center;
  double apart = 0;
  for (int i = 0; i < 500; ++i) {
    const Vector3d q = R * b.nearest(R.transpose() * (p - t)) + t;
    p = a.nearest(q);
    apart = (p - q).norm();
  }
  return apart;
}

class BoxGap : public testing::TestWithParam<double> {  // mm: how far the bodies' origins are off
 protected:
  std::mt19937 random{7};
  std::uniform_real_distribution<double> some{-1, 1};
  Vector3d vector() { return {some(random), some(random), some(random)}; }
  Matrix3d turn() {
    return Eigen::Quaterniond(some(random), some(random), some(random), some(random))
        .normalized()
        .toRotationMatrix();
  }
};

TEST_P(BoxGap, IsNeverOverstated) {
  const double nowhere = std::numeric_limits<double>::infinity();
  int near_it = 0;
  constexpr int pairs = 3000;
  for (int i = 0; i < pairs; ++i) {
    const Vector3d away = GetParam() * Vector3d(1, -0.5, 0.3);
    const double size = std::pow(10, 1.5 * some(random));
    const TurnedBox a{away + 20 * vector(), size * vector().cwiseAbs(), turn()};
    const TurnedBox b{-away + 20 * vector(), size * vector().cwiseAbs(), turn()};
    const Matrix3d R = turn();
    const Vector3d t = a.center - R * b.center + 20 * vector();
    const double apart = gap(a, b, R, t);
    const BoxTurn X(R, t, a.reach() + b.reach());
    const double bound = gap_bound(a.bound(), b.bound(), X, nowhere);
    EXPECT_LE(bound, apart) << size;
    EXPECT_LE(std::min(gap_bound(a.bound(), b.bound(), X, 0.5 * apart), apart), apart);
    near_it += bound > 0.7 * apart - 1e-3 - 1e-5 * GetParam();
  }
  EXPECT_GT(near_it, 0.9 * pairs);
}

TEST_P(BoxGap, IsKnownBetweenFacesThatSeeEachOther) {
  const Vector3d away = GetParam() * Vector3d(1, -0.5, 0.3);
  const TurnedBox a{away, {10, 5, 1}, Matrix3d::Identity()}, b{-away, {2, 3, 0.5}, turn()};
  const Matrix3d R = b.axes.transpose();
  for (double apart : {0.01, 1.0, 50.0}) {
    const Vector3d t = away + Vector3d(6, 4, 1.5 + apart) - R * b.center;
    const BoxTurn X(R, t, a.reach() + b.reach());
    EXPECT_NEAR(gap_bound(a.bound(), b.bound(), X, 1e9), apart, 1e-3 + 2e-5 * GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(FarFromTheOrigin, BoxGap, testing::Values(0.0, 300.0, 1e5));

}  // namespace
}  // namespace condyle
