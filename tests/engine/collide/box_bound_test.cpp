// The quick bound of two boxes' gap is never above it, wherever they lie, and near it where they
// face each other.
#include "engine/collide/box_bound.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
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
};

BoxPair twins(const TurnedBox (&boxes)[2]) {
  BoxPair both;
  for (int i = 0; i < 2; ++i) both.set(i, boxes[i].center, boxes[i].half, boxes[i].axes, i);
  return both;
}

/// Bounds of the gaps between all of two and two boxes: of [i] and [k] at 2 i + k.
FourFloats bounds(const TurnedBox (&a)[2], const TurnedBox (&b)[2], const BoxTransform& X) {
  return gap_bounds(twins(a), twins(b), X);
}

/// Boxes are convex: alternating projection between nearest points converges to the gap from above.
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
  int near_it = 0;
  constexpr int rounds = 750;
  for (int n = 0; n < rounds; ++n) {
    const Vector3d away = GetParam() * Vector3d(1, -0.5, 0.3);
    const double size = std::pow(10, 1.5 * some(random));
    const auto box = [&](const Vector3d& place) {
      return TurnedBox{place + 20 * vector(), size * vector().cwiseAbs(), turn()};
    };
    const TurnedBox a[2] = {box(away), box(away)}, b[2] = {box(-away), box(-away)};
    const Matrix3d R = turn();
    const Vector3d t = a[0].center - R * b[0].center + 20 * vector();
    const BoxTransform X(
        R, t, std::max(a[0].reach(), a[1].reach()) + std::max(b[0].reach(), b[1].reach()));
    const FourFloats found = bounds(a, b, X);
    const BoxDirection sight(vector().normalized(), R, t);
    const FourFloats along = gaps_along(twins(a), twins(b), sight, X.uncertain_mm);
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k) {
        const double apart = gap(a[i], b[k], R, t);
        EXPECT_LE(found[2 * i + k], apart) << size;
        EXPECT_LE(along[2 * i + k], apart) << size;
        near_it += found[2 * i + k] > 0.7 * apart - 1e-3 - 1e-5 * GetParam();
      }
  }
  EXPECT_GT(near_it, 0.9 * 4 * rounds);
}

TEST_P(BoxGap, IsKnownBetweenFacesThatSeeEachOther) {
  const Vector3d away = GetParam() * Vector3d(1, -0.5, 0.3);
  const TurnedBox a{away, {10, 5, 1}, Matrix3d::Identity()}, b{-away, {2, 3, 0.5}, turn()};
  const Matrix3d R = b.axes.transpose();
  for (double apart : {0.01, 1.0, 50.0}) {
    const Vector3d t = away + Vector3d(6, 4, 1.5 + apart) - R * b.center;
    const BoxTransform X(R, t, a.reach() + b.reach());
    EXPECT_NEAR(bounds({a, a}, {b, b}, X)[0], apart, 1e-3 + 2e-5 * GetParam());
    const BoxDirection sight(Vector3d::UnitZ(), R, t);
    EXPECT_NEAR(gaps_along(twins({a, a}), twins({b, b}), sight, X.uncertain_mm)[3], apart,
                1e-3 + 2e-5 * GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(FarFromTheOrigin, BoxGap, testing::Values(0.0, 300.0, 1e5));

}  // namespace
}  // namespace condyle
