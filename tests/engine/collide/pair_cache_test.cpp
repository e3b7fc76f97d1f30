// What a pair's queries keep from pose to pose makes them faster and changes no answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <random>
#include <thread>

#include "engine/collide/box_tree.h"
#include "engine/collide/collision_mesh.h"
#include "engine/collide/traversal_front.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Where a body lies on a path that comes near, crosses, rests, and now and then jumps away.
class Wandering {
 public:
  explicit Wandering(int seed) : random_(seed) {}
  Pose next() {
    std::uniform_real_distribution<double> one(-1, 1);
    ++k_;
    if (k_ % 7 == 0) return X_;
    if (k_ % 41 == 0) at_ = Vector3d(20 * one(random_), 20 * one(random_), 30 + 10 * one(random_));
    const double reach = 33 + 4 * std::sin(0.11 * (k_ / 3));  // two radii, more or less
    const double step = k_ % 3 == 0 ? 0.3 : 0.01;
    at_ = reach * (at_ + step * Vector3d(one(random_), one(random_), one(random_))).normalized();
    const Vector3d axis = Vector3d(one(random_), one(random_), one(random_)).normalized();
    X_.R = (Eigen::AngleAxisd(0.1 * step * one(random_), axis) * X_.R).normalized();
    X_.t = at_;
    return X_;
  }

 private:
  std::mt19937_64 random_;
  int k_ = 0;
  Vector3d at_ = {0, 0, 35};
  Pose X_;
};

void expect_same(const MeshDistance& x, const MeshDistance& y) {
  ASSERT_EQ(x.distance_mm, y.distance_mm);
  ASSERT_EQ(x.witness_a, y.witness_a);
  ASSERT_EQ(x.witness_b, y.witness_b);
  ASSERT_EQ(x.triangles.a, y.triangles.a);
  ASSERT_EQ(x.triangles.b, y.triangles.b);
}

TEST(PairCache, ChangesNoAnswerOnAnyPath) {
  const CollisionMesh ball(test::sphere(4, 18, {0, 0, 0}, 0.05)),
      bump(test::sphere(4, 15, {0, 0, 0}, 0.1)), box(test::box({-13, -13, -13}, {13, 13, 13}));
  int apart = 0, crossing = 0, limited = 0, near = 0;
  for (const CollisionMesh* other : {&bump, &box}) {
    PairCache cache;
    Wandering path(5);
    std::mt19937_64 random(3);
    TrianglePair last;
    const Pose X_WA = test::any_pose(random, 30);
    for (int k = 0; k < 400; ++k) {
      const Pose X_WB = X_WA * path.next();
      const MeshDistance cold = distance(ball, X_WA, *other, X_WB);
      expect_same(distance(ball, X_WA, *other, X_WB, last, &cache), cold);
      last = cold.triangles;
      const auto within = distance_within(1, ball, X_WA, *other, X_WB, last, &cache);
      ASSERT_EQ(within.has_value(), cold.distance_mm < 1);
      if (within) expect_same(*within, cold);
      near += within.has_value();
      const int total = k % 5 == 0 ? 6 : 4096;  // a query may end early
      const auto plain = contacts(ball, X_WA, *other, X_WB, {.total = total});
      const auto kept = contacts(ball, X_WA, *other, X_WB, {.total = total}, &cache);
      ASSERT_EQ(plain.size(), kept.size()) << k;
      for (std::size_t i = 0; i < plain.size(); ++i) {
        ASSERT_EQ(plain[i].triangles.a, kept[i].triangles.a);
        ASSERT_EQ(plain[i].triangles.b, kept[i].triangles.b);
        ASSERT_EQ(plain[i].point, kept[i].point);
      }
      ++(plain.empty() ? apart : crossing);
      limited += plain.size() == 6;
    }
  }
  EXPECT_GT(apart, 200);
  EXPECT_GT(crossing, 200);
  EXPECT_GT(limited, 20);
  EXPECT_GT(near, 250);
}

// Far from the origin, where coordinates are rounded more, and so near that many triangles are at
// the same distance to rounding.
TEST(PairCache, ChangesNoAnswerWhereSurfacesSlideOnEachOther) {
  const Vector3d a_center(140, -150, 160), b_center(-130, 150, 140);
  const CollisionMesh a(test::sphere(4, 18, a_center, 0.05)), b(test::sphere(4, 15, b_center, 0.1));
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> one(-1, 1);
  const Pose X_WA;
  Vector3d from_a(0, 0, 34);  // to B's center
  PairCache cache;
  int went_on = 0, together = 0, near = 0;
  TrianglePair last;
  for (int k = 0; k < 600; ++k) {
    const Eigen::AngleAxisd turn(2e-4 * one(random), Vector3d(one(random), 1, 0.3).normalized());
    from_a = turn * from_a;
    Pose X_WB;
    X_WB.R = Eigen::Quaterniond(Eigen::AngleAxisd(1e-4 * k, Vector3d::UnitX()));
    const auto place = [&] { X_WB.t = a_center + from_a - X_WB.R * b_center; };
    place();
    const double wanted_mm = 0.0055 + 0.0045 * std::sin(0.05 * k);
    const double gap_mm = distance(a, X_WA, b, X_WB).distance_mm;
    const double outward_mm = gap_mm > 0 ? std::clamp(wanted_mm - gap_mm, -0.02, 0.02) : 0.01;
    from_a += outward_mm * from_a.normalized();
    place();
    const MeshDistance cold = distance(a, X_WA, b, X_WB);
    expect_same(distance(a, X_WA, b, X_WB, last), cold);
    expect_same(distance(a, X_WA, b, X_WB, last, &cache), cold);
    went_on += !cache.nearest.at_roots();
    near += cold.distance_mm < 0.02;
    last = cold.triangles;
    const auto plain = contacts(a, X_WA, b, X_WB), kept = contacts(a, X_WA, b, X_WB, {}, &cache);
    ASSERT_EQ(plain.size(), kept.size()) << k;
    together += !plain.empty();
  }
  EXPECT_GT(went_on, 500);
  EXPECT_GT(near, 300);
  EXPECT_LT(together, 300);
}

TEST(PairCache, GoesOnWhereTheLastQueryEnded) {
  const TriMesh mesh = test::sphere(4, 15);
  const BoxTree a(mesh), b(mesh);
  TraversalFront front;
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  EXPECT_FALSE(front.begin(a.boxes, b.boxes, X)) << "the first query";
  ASSERT_TRUE(front.begin(a.boxes, b.boxes, X));
  EXPECT_TRUE(front.at_roots());
  front.add(0, 0, 2);
  front.finish();
  X.rotate(Eigen::AngleAxisd(0.001, Vector3d::UnitX()));
  X.translation().y() = 0.02;
  ASSERT_TRUE(front.begin(a.boxes, b.boxes, X));
  ASSERT_FALSE(front.at_roots());
  // A point of the ball has moved by the shift and along its largest circle.
  EXPECT_LT(front.gap_mm(front.ends()[0]), 2 - 0.02 - 0.001 * 15);
  EXPECT_GT(front.gap_mm(front.ends()[0]), 2 - 0.02 - 0.001 * 15 * std::sqrt(3) - 0.001);
  front.keep(front.ends()[0]);
  front.finish();
  X.translation().y() = 1;
  EXPECT_FALSE(front.begin(a.boxes, b.boxes, X)) << "it moves fast";
  ASSERT_TRUE(front.begin(a.boxes, b.boxes, X));
  EXPECT_TRUE(front.at_roots()) << "far from where the front was";
  EXPECT_FALSE(front.begin(b.boxes, a.boxes, X)) << "of other surfaces";
}

TEST(PairCache, ThreadsMayShareIt) {
  const CollisionMesh a(test::sphere(4, 18, {0, 0, 0}, 0.05)), b(test::sphere(4, 15));
  PairCache cache;
  std::vector<std::vector<MeshDistance>> found(2);
  const auto run = [&](std::size_t thread) {
    for (int k = 0; k < 200; ++k)
      found[thread].push_back(
          distance(a, {}, b, test::shift(0.002 * k, 0, 34 - 0.001 * k), {}, &cache));
  };
  std::thread other([&] { run(1); });
  run(0);
  other.join();
  for (int k = 0; k < 200; ++k) {
    const MeshDistance alone = distance(a, {}, b, test::shift(0.002 * k, 0, 34 - 0.001 * k));
    expect_same(found[0][k], alone);
    expect_same(found[1][k], alone);
    const std::lock_guard held(cache.in_use);  // as by another thread
    expect_same(distance(a, {}, b, test::shift(0.002 * k, 0, 34 - 0.001 * k), {}, &cache), alone);
  }
}

}  // namespace
}  // namespace condyle
