#include "sim/contact/motion_sweep.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A row of small boxes: its parts have different paths.
TriMesh rod() {
  TriMesh rod;
  for (double x = -30; x < 30; x += 2)
    rod = test::joined(rod, test::box({x, -4, -4}, {x + 2, 4, 4}));
  return rod;
}

TEST(SweptPair, ReportedClearFromItsEndItIsClearOnTheWholePathWhicheverSideMoves) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto direction = [&] { return Vector3d(any(random), any(random), any(random)); };
  const TriMesh bumpy = test::sphere(2, 20, {0, 0, 0}, 0.05), long_one = rod();
  const Collider ball{0, 0, cranium_body, false, std::make_shared<ColliderShape>(bumpy)};
  const Collider lever{1, 1, mandible_body, false, std::make_shared<ColliderShape>(long_one)};
  int clear = 0, not_clear = 0, clear_by_parts = 0;
  for (int trial = 0; trial < 400; ++trial) {
    ColliderPair pair;
    const bool a_moves = trial % 2 == 1;
    pair.a = a_moves ? &lever : &ball;
    pair.b = a_moves ? &ball : &lever;
    SweptPair p;
    p.pair = &pair;
    p.a_moves = a_moves;
    p.X_CS = test::any_pose(random, 10);
    if (trial % 4 > 1) p.X_DM = test::any_pose(random, 20);
    const Pose X_CM = p.X_CS * test::any_pose(random, 40);
    p.to = p.X_DM ? X_CM * p.X_DM->inverse() : X_CM;
    const Eigen::AngleAxisd turn(0.2 * any(random), direction().normalized());
    p.from = {p.to.R * turn, p.to.t + 4 * direction()};
    p.pivot_D = 30 * direction();
    p.min_distance_mm = trial % 3;
    p.measure();
    const PairContact at_end = p.query(p.to, {}, {});
    if (at_end.touching) continue;
    const bool reported = p.clear(at_end);
    ++(reported ? clear : not_clear);
    clear_by_parts += reported && p.margin(at_end) <= p.length_mm;
    for (int k = 0; reported && k < 25; ++k) {
      const PairContact on_path = p.query(interpolate(p.from, p.to, k / 25.0, p.pivot_D), {}, {});
      EXPECT_FALSE(on_path.touching) << trial;
      EXPECT_GE(on_path.distance_mm, p.min_distance_mm) << trial;
    }
  }
  EXPECT_GT(clear, 50);
  EXPECT_GT(not_clear, 50);
  EXPECT_GT(clear_by_parts, 15);
}

TEST(SweptPair, WithNaNsIsNotReportedClear) {
  const TriMesh mesh = test::box({-1, -1, -1}, {1, 1, 1});
  const Collider one{0, 0, cranium_body, false, std::make_shared<ColliderShape>(mesh)};
  const Collider other{1, 1, mandible_body, false, std::make_shared<ColliderShape>(mesh)};
  ColliderPair pair;
  pair.a = &one;
  pair.b = &other;
  SweptPair p;
  p.pair = &pair;
  p.pivot_D = Vector3d::Zero();
  p.to.t = {5, 0, 0};
  const PairContact at_end = p.query(p.to, {}, {});
  p.measure();
  EXPECT_FALSE(p.clear(at_end));  // it emerged from the other
  p.from.t = {9, 0, 0};
  p.measure();
  EXPECT_FALSE(p.clear(at_end));  // its path is longer than its distance
  p.from.t = {6, 0, 0};
  p.measure();
  EXPECT_TRUE(p.clear(at_end));
  p.from.t = {std::nan(""), 0, 0};
  p.measure();
  EXPECT_FALSE(p.clear(at_end));
}

}  // namespace
}  // namespace condyle
