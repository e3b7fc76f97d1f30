#include "engine/collide/slide.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>
#include <random>

#include "engine/collide/collision_mesh.h"
#include "tests/engine/collide/slide_bodies.h"
#include "tests/support/boxes.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::body;
using test::plate;
using test::shift;

Pose turned(const Vector3d& axis, double degrees, const Vector3d& t) {
  return {Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized())), t};
}

/// Largest displacement of any point of a 10 mm body between two poses.
double apart(const Pose& a, const Pose& b) {
  return (a.t - b.t).norm() + 10 * rotation_angle(a.inverse() * b);
}

TEST(Slide, FreeMotionReachesTheTargetExactly) {
  const SlidingContact model({body(plate())}, {body(test::sphere(4, 5))});
  const Pose target = turned({1, 2, 3}, 20, {3, 1, 5.5});
  const SlideResult result = model.slide(shift(-8, 0, 12), target);
  EXPECT_EQ(result.X_FM.t, target.t);
  EXPECT_EQ(result.X_FM.R.coeffs(), target.R.coeffs());
  EXPECT_FALSE(result.touching);
  EXPECT_TRUE(result.settled);
}

TEST(Slide, SphereSlidesAlongThePlane) {
  const SlidingContact model({body(plate())}, {body(test::sphere(5, 5))});
  for (const double deep : {0.1, 1.0, 3.0}) {
    const SlideResult result = model.slide(shift(-6, 2, 7), shift(5, -3, 5 - deep));
    EXPECT_TRUE(result.settled);
    EXPECT_TRUE(result.touching);
    EXPECT_NEAR(result.X_FM.t.z(), 5, 0.04);  // slop and facets
    EXPECT_NEAR(result.X_FM.t.x(), 5, 0.02);
    EXPECT_NEAR(result.X_FM.t.y(), -3, 0.02);
    ASSERT_FALSE(result.contacts.empty());
    EXPECT_GT(result.contacts.front().normal.z(), 0.999);
    EXPECT_NEAR(result.contacts.front().point.z(), 0, 0.03);
  }
}

TEST(Slide, BoxSettlesInAGrooveAndRunsAlongIt) {
  // Two plates leaning at 45 degrees; the groove's bottom is the y axis.
  const TriMesh left =
      test::moved(test::box({0, -15, -3}, {14, 15, 0}), turned({0, 1, 0}, -45, {0, 0, 0}));
  const TriMesh right =
      test::moved(test::box({-14, -15, -3}, {0, 15, 0}), turned({0, 1, 0}, 45, {0, 0, 0}));
  const SlidingContact model({body(left), body(right)}, {body(test::box({-3, -4, -3}, {3, 4, 3}))});
  // Standing on an edge it fits the groove exactly: its middle lies a diagonal above the bottom.
  const Pose from = turned({0, 1, 0}, 40, {1, -5, 9});
  const SlideResult result = model.slide(from, turned({0, 1, 0}, 45, {0.5, 6, 2}));
  EXPECT_TRUE(result.settled);
  EXPECT_NEAR(result.X_FM.t.x(), 0, 0.05);
  EXPECT_NEAR(result.X_FM.t.y(), 6, 0.05);
  EXPECT_NEAR(result.X_FM.t.z(), 3 * std::sqrt(2.0), 0.05);
  const Pose fit = turned({0, 1, 0}, 45, {0, 0, 0});
  EXPECT_LT(rotation_angle(fit.inverse() * result.X_FM), 0.02);
}

TEST(Slide, ALongJumpDoesNotPassThroughAThinWall) {
  const SlidingContact model({body(plate(0.6))}, {body(test::sphere(4, 4))});
  for (const double x : {0.0, 3.3}) {
    const SlideResult result = model.slide(shift(x, 0, 25), shift(x, 0, -20));
    EXPECT_NEAR(result.X_FM.t.z(), 4, 0.05);
    EXPECT_NEAR(result.X_FM.t.x(), x, 0.1);
    EXPECT_LE(result.depth_mm, 0.02);
  }
}

TEST(Slide, EdgeStopsAtEdge) {
  // Two ridges across each other, whose corners are nowhere near.
  const TriMesh ridge =
      test::moved(test::box({-3, -20, -3}, {3, 20, 3}), turned({0, 1, 0}, 45, {0, 0, 0}));
  const TriMesh across = test::moved(ridge, turned({0, 0, 1}, 90, {0, 0, 0}));
  SlideSettings stiff;
  stiff.rotation_length_mm = 1000;  // hardly turns
  const SlidingContact model({body(ridge)}, {body(across)}, stiff);
  const test::OverlapOracle fixed(ridge), moving(across);
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> offset(-1.5, 1.5);
  for (int k = 0; k < 20; ++k) {
    const double x = offset(random), y = offset(random);
    const SlideResult result =
        model.slide(shift(x, y, 12), turned({0, 0, 1}, 10 * offset(random), {x, y, 7}));
    EXPECT_TRUE(result.settled);
    EXPECT_LE(deepest(fixed, moving, result.X_FM), 0.06);
    EXPECT_LT(result.X_FM.t.z(), 6 * std::sqrt(2.0) + 0.01);  // nor does it hover
  }
}

TEST(Slide, FrictionHoldsBelowItsCoefficientAndSlidesAbove) {
  SlideSettings rough;
  rough.friction = 0.3;
  const SlidingContact model({body(plate())}, {body(test::box({-3, -3, 0}, {3, 3, 4}))}, rough);
  const double press = 0.5;
  const Pose start = model.slide(shift(0, 0, 0.5), shift(0, 0, -0.01)).X_FM;
  for (const double fraction : {0.5, 0.8, 1.3, 2.0}) {  // of what friction holds
    const double sideways = fraction * rough.friction * press;
    const SlideResult result = model.slide(start, shift(sideways, 0, -press));
    const double slip = result.X_FM.t.x() - start.t.x();
    if (fraction < 1) {
      EXPECT_NEAR(slip, 0, 0.02) << fraction;
    } else {
      EXPECT_NEAR(slip, sideways - rough.friction * press, 0.03) << fraction;
    }
    EXPECT_NEAR(result.X_FM.t.z(), 0, 0.03);
  }
}

TEST(Slide, TurnedSceneGivesTheTurnedAnswer) {
  std::mt19937_64 random(32);
  const TriMesh floor = test::box({-15, -15, -4}, {15, 15, 0});
  const TriMesh wall =
      test::moved(test::box({-4, -15, -5}, {0, 15, 15}), turned({0, 1, 0}, 10, {0, 0, 0}));
  const TriMesh bumpy = test::sphere(4, 9, {0, 0, 0}, 0.05);
  const auto ball = body(test::sphere(4, 4, {0, 0, 0}, 0.04));
  const SlidingContact corner({body(floor), body(wall)}, {ball}), hill({body(bumpy)}, {ball});
  const Pose in_corner = turned({1, 0, 0}, 5, {3, 1, 2}),
             on_hill = turned({1, 0, 0}, 5, {1, 0.5, 11});
  for (int k = 0; k < 3; ++k) {
    const Pose X = test::any_pose(random, 15);
    const SlidingContact turned_corner({body(test::moved(floor, X)), body(test::moved(wall, X))},
                                       {ball});
    const Pose from = shift(8, -3, 8);
    const SlideResult here = corner.slide(from, in_corner);
    EXPECT_TRUE(here.touching);
    const Pose there = X.inverse() * turned_corner.slide(X * from, X * in_corner).X_FM;
    // Both are as near to the target pose as the slop lets them be. What is less than 0.01 mm
    // nearer, of 2.9 mm, may lie sqrt(2 * 2.9 * 0.01) mm beside it: a ball that turns in a corner
    // finds many such places, and which one hangs on the lattice it comes from.
    const auto left = [&](const Pose& Y) {
      return std::hypot((Y * corner.pivot() - in_corner * corner.pivot()).norm(),
                        corner.rotation_length_mm() * rotation_angle(Y.inverse() * in_corner));
    };
    EXPECT_NEAR(left(here.X_FM), left(there), 0.01);
    EXPECT_LT((here.X_FM.t - there.t).norm(), 0.05);
    EXPECT_LT(corner.rotation_length_mm() * rotation_angle(here.X_FM.inverse() * there), 0.24);
    // On a hilltop directions are flat, and the position less certain than the distance.
    const SlidingContact turned_hill({body(test::moved(bumpy, X))}, {ball});
    const Pose above = shift(0, 1, 16);
    const Pose first = hill.slide(above, on_hill).X_FM,
               second = X.inverse() * turned_hill.slide(X * above, X * on_hill).X_FM;
    EXPECT_NEAR((first.t - on_hill.t).norm(), (second.t - on_hill.t).norm(), 0.04);
    EXPECT_LT(apart(first, second), 0.4);
  }
}

TEST(Slide, DifferentPathsEndAtTheSamePose) {
  // A ball between a floor and a leaning wall.
  const TriMesh floor = test::box({-15, -15, -4}, {15, 15, 0});
  const TriMesh wall =
      test::moved(test::box({-4, -15, -5}, {0, 15, 15}), turned({0, 1, 0}, 10, {0, 0, 0}));
  const SlidingContact model({body(floor), body(wall)}, {body(test::sphere(4, 4))});
  const Pose target = shift(3, 1, 2);
  const Pose first = model.slide(shift(8, -3, 8), target).X_FM;
  for (const Pose& from : {shift(12, 8, 5), shift(6, 0, 12), shift(9, 9, 9), shift(5.5, -8, 4.5)}) {
    const SlideResult result = model.slide(from, target);
    EXPECT_TRUE(result.settled);
    EXPECT_LT(apart(result.X_FM, first), 0.05);
  }
}

TEST(Slide, AnAnswerIsItsOwnAnswer) {
  const SlidingContact model({body(test::sphere(4, 9, {0, 0, 0}, 0.05))},
                             {body(test::sphere(4, 5, {0, 0, 0}, 0.05))});
  std::mt19937_64 random(33);
  int touching = 0;
  for (int k = 0; k < 20; ++k) {
    const Vector3d direction = test::any_pose(random, 1).R * Vector3d::UnitX();
    SlideCache memory;
    const Pose target = turned(direction, 10, 12.5 * direction);
    SlideResult result = model.slide({Quaterniond::Identity(), 20 * direction}, target, &memory);
    touching += result.touching;
    for (int again = 0; again < 3; ++again) {
      const SlideResult next = model.slide(result.X_FM, target, &memory);
      EXPECT_EQ(next.X_FM.t, result.X_FM.t);
      EXPECT_LT(apart(model.slide(result.X_FM, target).X_FM, result.X_FM), 0.05);
      result = next;
    }
  }
  EXPECT_EQ(touching, 20);
}

TEST(Slide, OverlapAtRestIsTheBaseline) {
  SlidingContact model({body(plate())}, {body(test::box({-3, -3, -0.4}, {3, 3, 4}))});
  EXPECT_NEAR(model.depth({}), 0.4, 0.01);
  model.allow_overlap_at({});
  EXPECT_NEAR(model.depth({}), 0, 1e-6);
  const SlideResult pressed = model.slide({}, shift(0, 0, -1));
  EXPECT_NEAR(pressed.X_FM.t.z(), 0, 0.03);
  const SlideResult away = model.slide({}, shift(1, 0, 3));
  EXPECT_EQ(away.X_FM.t, Vector3d(1, 0, 3));
}

TEST(Slide, PairsKeepTheirGap) {
  const auto floor = body(plate());
  const auto ball = body(test::sphere(4, 5));
  for (const double gap : {0.0, 0.2, 0.5}) {
    const SlidingContact model({floor}, {ball}, {{0, 0, gap}});
    const SlideResult result = model.slide(shift(-6, 2, 7), shift(5, -3, 4));
    EXPECT_TRUE(result.settled);
    EXPECT_NEAR(result.X_FM.t.z(), 5 + gap, 0.04);
    EXPECT_NEAR(result.X_FM.t.x(), 5, 0.02);
    EXPECT_NEAR(model.depth(shift(0, 0, 4.8 + gap)), 0.2, 0.02);
  }
  // A gap that is narrower at rest may stay so.
  SlidingContact rest({floor}, {ball}, {{0, 0, 0.4}});
  rest.allow_overlap_at(shift(0, 0, 5.1));
  EXPECT_NEAR(rest.depth(shift(0, 0, 5.1)), 0, 1e-6);
  EXPECT_NEAR(rest.slide(shift(0, 0, 5.1), shift(0, 0, 4)).X_FM.t.z(), 5.1, 0.03);
  // Pairs that are not named pass through each other.
  const SlidingContact none({floor, body(test::box({-3, -3, 20}, {3, 3, 22}))}, {ball},
                            {{1, 0, 0}});
  EXPECT_EQ(none.slide(shift(0, 0, 8), shift(0, 0, 1)).X_FM.t, Vector3d(0, 0, 1));
  EXPECT_THROW(SlidingContact({floor}, {ball}, {{0, 1, 0}}), std::invalid_argument);
  EXPECT_THROW(SlidingContact({floor}, {ball}, {{0, 0, 0.6}}), std::invalid_argument);
  EXPECT_THROW(SlidingContact({floor}, {ball}, {{0, 0, -0.1}}), std::invalid_argument);
}

TEST(Slide, OverlapIsProvedOnlyWhereTheSurfacesCross) {
  const TriMesh a = test::sphere(4, 5, {0, 0, 0}, 0.04), b = test::sphere(4, 4, {0, 0, 0}, 0.04);
  const CollisionMesh surface_a(a), surface_b(b);
  const auto fixed = body(a), moving = body(b);
  const SlidingContact proves({fixed}, {moving}, {{0, 0, 0, true}}),
      silent({fixed}, {moving}, {{0, 0, 0, false}});
  SlidingContact sunk({fixed}, {moving}, {{0, 0, 0, true}});
  sunk.allow_overlap_at(shift(8.5, 0, 0));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1), distance(7.5, 9.5);
  SlideCache memory, quiet, rest;
  int proved = 0, crossing = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3d out = Vector3d(any(random), any(random), any(random)).normalized();
    const Pose X = turned({any(random), any(random), 1}, 90 * any(random), distance(random) * out);
    const bool crosses = touching(surface_a, {}, surface_b, X),
               sure = proves.surely_overlaps(X, memory);
    EXPECT_TRUE(crosses || !sure);
    EXPECT_FALSE(silent.surely_overlaps(X, quiet) || sunk.surely_overlaps(X, rest));
    crossing += crosses;
    proved += sure;
  }
  EXPECT_GT(crossing, 100);
  EXPECT_GT(proved, crossing / 2);
  EXPECT_LT(crossing, 200);
}

TEST(Slide, SurfacesAtOtherPosesSlideThere) {
  const TriMesh floor = plate(), wall = test::box({-4, -15, -5}, {0, 15, 15});
  const auto ball = body(test::sphere(4, 4, {0, 0, 0}, 0.04));
  const Pose X_wall = turned({0, 1, 0}, 10, {-3, 0, 0}), X_ball = turned({1, 1, 0}, 30, {2, 1, 6});
  SlidingContact placed({body(floor), body(wall)}, {ball},
                        {.rotation_length_mm = 3, .pivot = Vector3d(2, 1, 6)});
  placed.place({{}, X_wall}, {X_ball});
  const SlidingContact made({body(floor), body(test::moved(wall, X_wall))}, {ball},
                            {.rotation_length_mm = 3, .pivot = Vector3d(0, 0, 0)});
  for (const Vector3d& target : {Vector3d(1, 1, 2), Vector3d(0, -2, 3.5), Vector3d(6, 3, 9)}) {
    const Pose there = turned({0, 0, 1}, 4, target), from = shift(4, 0, 9);
    const SlideResult a = placed.slide(from * X_ball.inverse(), there * X_ball.inverse()),
                      b = made.slide(from, there);
    EXPECT_EQ(a.touching, b.touching);
    EXPECT_LT(apart(a.X_FM * X_ball, b.X_FM), 0.06);  // fields on other grids
  }
  EXPECT_THROW(placed.place({{}}, {X_ball}), std::invalid_argument);
  // Allowed overlap moves along.
  SlidingContact sunk({body(plate())}, {body(test::box({-3, -3, -0.4}, {3, 3, 4}))});
  sunk.allow_overlap_at({});
  const Pose X = turned({1, 2, 3}, 50, {30, 5, 9});
  sunk.place({X}, {{}});
  EXPECT_NEAR(sunk.depth(X), 0, 1e-6);
  EXPECT_LT(apart(sunk.slide(X, X * shift(0, 0, -1)).X_FM, X), 0.05);
}

TEST(Slide, AllowedOverlapFadesWithDistanceFromItsPose) {
  SlidingContact model({body(plate())}, {body(test::sphere(4, 5))});
  const double deep = 0.4;
  model.allow_overlap_at(shift(0, 0, 5 - deep), 2.0);
  EXPECT_NEAR(model.depth(shift(0, 0, 5 - deep)), 0, 1e-6);
  EXPECT_NEAR(model.depth(shift(0, 4, 5 - deep)), deep, 0.03);
  // Pressed down it stays; dragged sideways it leaves the overlap and stays outside.
  EXPECT_NEAR(model.slide(shift(0, 0, 5 - deep), shift(0, 0, 4)).X_FM.t.z(), 5 - deep, 0.05);
  double last = 5 - deep - 0.02;
  Pose X = shift(0, 0, 5 - deep);
  for (int k = 1; k <= 12; ++k) {
    X = model.slide(X, shift(0.25 * k, 0, 5 - deep)).X_FM;
    EXPECT_NEAR(X.t.x(), 0.25 * k, 0.1);
    EXPECT_GE(X.t.z(), last - 0.02);
    last = X.t.z();
  }
  EXPECT_NEAR(last, 5, 0.04);
}

TEST(Slide, AStartThatOverlapsIsMovedOut) {
  const SlidingContact model({body(plate())}, {body(test::sphere(4, 5))});
  const SlideResult result = model.slide(shift(0, 0, 4.5), shift(0, 0, 4.4));
  EXPECT_NEAR(result.X_FM.t.z(), 5, 0.05);
  EXPECT_LE(result.depth_mm, 0.02);
}

TEST(Slide, ReportsWhetherItsPathIsFree) {
  const SlidingContact model({body(plate())}, {body(test::sphere(4, 5))});
  EXPECT_TRUE(model.slide(shift(-6, 2, 7), shift(5, -3, 4)).reached);      // along the plane
  EXPECT_TRUE(model.slide(shift(0, 0, 40), shift(0, 0, -30)).reached);     // a long jump stopped
  EXPECT_TRUE(model.slide(shift(-8, 0, 12), shift(3, 1, 5.5)).reached);    // all free
  const SlideResult inside = model.slide(shift(0, 0, 3), shift(0, 0, 4));  // starts too deep
  EXPECT_FALSE(inside.reached);
}

TEST(Slide, PosesThatAreNotFiniteMoveNothing) {
  const SlidingContact model({body(plate())}, {body(test::sphere(2, 5))});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const SlideResult result = model.slide(shift(1, 2, 9), shift(nan, 0, 0));
  EXPECT_FALSE(result.settled);
  EXPECT_EQ(result.X_FM.t, Vector3d(1, 2, 9));
  EXPECT_FALSE(model.slide(shift(0, nan, 9), shift(0, 0, 8)).settled);
}

/// Poses of a bumpy ball that grinds on another; depths of those that touch.
std::vector<Pose> grind(int frames, int threads, const TriMesh& a, const TriMesh& b,
                        std::vector<double>* depths) {
  const SlidingContact model({body(a)}, {body(b)});
  const test::OverlapOracle fixed(a), moving(b);
  SlideCache memory;
  Pose X = shift(0, 0, 20);
  std::vector<Pose> poses;
  for (int f = 0; f < frames; ++f) {
    const double s = 0.06 * f;
    const Pose target = turned({0.2, 1, 0.4}, 12 * std::sin(1.7 * s),
                               {2 * std::sin(s), 2 * std::sin(1.3 * s), 13.2 + 6 * std::exp(-s)});
    const SlideResult result = model.slide(X, target, &memory, threads);
    X = result.X_FM;
    poses.push_back(X);
    if (depths && result.touching) depths->push_back(deepest(fixed, moving, X));
  }
  return poses;
}

TEST(Slide, BumpyBallsGrindWithoutOverlap) {
  const TriMesh a = test::sphere(4, 9, {0, 0, 0}, 0.06), b = test::sphere(4, 6, {0, 0, 0}, 0.06);
  std::vector<double> depths;
  grind(300, 1, a, b, &depths);
  ASSERT_GT(depths.size(), 200u);
  std::sort(depths.begin(), depths.end());
  EXPECT_LE(depths.back(), 0.1);
  EXPECT_LE(depths[depths.size() / 2], 0.05);
}

TEST(Slide, CachedNodesChangeNoBit) {
  const SlidingContact model({body(test::sphere(4, 9, {0, 0, 0}, 0.06))},
                             {body(test::sphere(4, 6, {0, 0, 0}, 0.06))});
  const auto target_at = [](int f) {
    const double s = 0.2 * f;
    return turned({0.2, 1, 0.4}, 12 * std::sin(1.7 * s),
                  {2 * std::sin(s), 2 * std::sin(1.3 * s), 12.5});
  };
  constexpr int frames = 30;
  SlideCache forward, backward;
  const Pose from = shift(0, 0, 15.5);
  for (int f = frames; f >= 0; --f) model.slide(from, target_at(f), &backward);
  int touching = 0;
  for (int f = 0; f <= frames; ++f) {
    const SlideResult a = model.slide(from, target_at(f), &forward),
                      b = model.slide(from, target_at(f), &backward, 2),
                      c = model.slide(from, target_at(f));
    touching += a.touching;
    for (const SlideResult& other : {b, c}) {
      EXPECT_EQ(a.X_FM.t, other.X_FM.t) << f;
      EXPECT_EQ(a.X_FM.R.coeffs(), other.X_FM.R.coeffs()) << f;
      EXPECT_EQ(a.reached, other.reached) << f;
    }
  }
  EXPECT_GT(touching, 25);
}

TEST(Slide, IsBitIdenticalOnOneAndTwoThreads) {
  const TriMesh a = test::sphere(4, 9, {0, 0, 0}, 0.06), b = test::sphere(4, 6, {0, 0, 0}, 0.06);
  const auto one = grind(60, 1, a, b, nullptr), two = grind(60, 2, a, b, nullptr);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].t, two[i].t);
    EXPECT_EQ(one[i].R.coeffs(), two[i].R.coeffs());
  }
}

}  // namespace
}  // namespace condyle
