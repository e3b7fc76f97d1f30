#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/engine/rigid/scene.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Kind = RigidJoint::Kind;

const TriMesh hanging_plank = test::box({-2, -3, -20}, {2, 3, 0});

/// Largest error of the joints over a run, and the largest gain of energy.
struct Swing {
  double error_mm = 0, gain = 0, loss = 0;
};
Swing swing(RigidWorld& world, double seconds) {
  Swing out;
  const double start = world.kinetic_energy() + world.potential_energy();
  for (int k = 0; k < static_cast<int>(seconds * 1000); ++k) {
    const auto step = world.step();
    EXPECT_TRUE(step.taken);
    out.error_mm = std::max(out.error_mm, step.joint_error_mm);
    const double energy = world.kinetic_energy() + world.potential_energy();
    out.gain = std::max(out.gain, energy - start);
    out.loss = std::max(out.loss, start - energy);
  }
  return out;
}

TEST(Joint, ABallPendulumStaysAtItsPointAndKeepsItsEnergy) {
  RigidWorld world;
  const int wall = world.add_body({});
  const int id = world.add_body(test::ghost(hanging_plank, test::turned({1, 0, 0}, 80, {5, 0, 0})));
  world.add_joint({.kind = Kind::ball, .a = wall, .b = id, .p_A = {5, 0, 0}});
  const double scale = world.mass(id).mass_kg * 9.81 * 10;
  const Swing s = swing(world, 3);
  EXPECT_LT(s.error_mm, 0.02);
  EXPECT_LT(s.gain, 0.02 * scale);
  EXPECT_LT(s.loss, 0.05 * scale);
}

TEST(Joint, AChainOfPendulumsHolds) {
  RigidWorld world;
  int last = world.add_body({});
  const Vector3d end(0, 0, -20);
  Pose X = test::turned({1, 0, 0}, 40, {0, 0, 0});
  Vector3d hook = Vector3d::Zero();
  for (int k = 0; k < 4; ++k) {
    const int id = world.add_body(test::ghost(hanging_plank, X));
    world.add_joint({.kind = Kind::ball, .a = last, .b = id, .p_A = hook});
    X.t = X * end;
    hook = end;
    last = id;
  }
  EXPECT_LT(swing(world, 1).error_mm, 0.02);
}

TEST(Joint, AHingeTurnsAboutItsAxisOnly) {
  RigidWorld world;
  const int wall = world.add_body({});
  const int id = world.add_body(test::ghost(hanging_plank, test::turned({1, 0, 0}, 60, {0, 0, 0})));
  world.add_joint({.kind = Kind::hinge, .a = wall, .b = id});
  world.set_motion(id, {{3, 0, 0}, {0, 2, 2}});  // a motion that the hinge excludes
  EXPECT_LT(swing(world, 2).error_mm, 0.02);
  EXPECT_GT((world.pose(id).R * Vector3d::UnitX()).x(), 1 - 1e-6);
  EXPECT_GT(world.motion(id).spin.norm(), 0.5);
  EXPECT_LT(world.motion(id).spin.tail<2>().norm(), 1e-3 * world.motion(id).spin.norm());
}

TEST(Joint, AFixedJointMovesTwoBodiesAsOne) {
  RigidWorld world(test::weightless());
  const Pose X_WA = test::turned({1, 2, 0}, 30, {1, 2, 3}),
             X_AB = test::turned({0, 1, 1}, 40, {8, 0, 0});
  DynamicBody a = test::ghost(hanging_plank, X_WA);
  a.motion = {{20, 0, 0}, {3, 4, 5}};
  const int first = world.add_body(a),
            second = world.add_body(test::ghost(hanging_plank, X_WA * X_AB));
  world.add_joint({.kind = Kind::fixed, .a = first, .b = second, .X_AB = X_AB});
  const Vector3d p = world.momentum(), L = world.angular_momentum();
  double error = 0;
  for (int k = 0; k < 1000; ++k) error = std::max(error, world.step().joint_error_mm);
  EXPECT_LT(error, 0.02);
  EXPECT_LT(test::apart(world.pose(first) * X_AB, world.pose(second)), 0.02);
  EXPECT_LT((world.momentum() - p).norm(), 1e-9 * p.norm());
  EXPECT_LT((world.angular_momentum() - L).norm(), 1e-4 * L.norm());
}

TEST(Joint, AGuideLeadsAlongItsCurveUpToItsStops) {
  RigidWorld world;
  const int wall = world.add_body({});
  // A slope like an eminence, descending forward.
  std::vector<Vector3d> curve;
  for (int k = 0; k <= 10; ++k) curve.emplace_back(0, -k, -0.08 * k * k);
  DynamicBody body = test::ghost(test::box({-3, -3, -3}, {3, 3, 3}), test::at(0, 0, 0));
  const int id = world.add_body(body);
  world.add_joint({.kind = Kind::guide, .a = wall, .b = id, .curve_A = curve});
  world.add_force({.body = id, .force_N = {0, -0.002, 0}});
  double error = 0, lowest = 0;
  for (int k = 0; k < 1500; ++k) {
    error = std::max(error, world.step().joint_error_mm);
    lowest = std::min(lowest, world.pose(id).t.y());
    const double y = world.pose(id).t.y();
    EXPECT_NEAR(world.pose(id).t.z(), -0.08 * y * y, 0.03);
  }
  EXPECT_LT(error, 0.02);
  EXPECT_NEAR(world.pose(id).t.y(), -10, 0.03);  // at the front stop
  EXPECT_GT(lowest, -10.03);
}

TEST(Joint, AGuideWithFreePlaySidewaysIsASurface) {
  RigidWorld world(test::weightless());
  const int wall = world.add_body({});
  DynamicBody body = test::ghost(test::box({-3, -3, -3}, {3, 3, 3}));
  body.motion.velocity = {7, -20, 30};
  const int id = world.add_body(body);
  world.add_joint({.kind = Kind::guide,
                   .a = wall,
                   .b = id,
                   .curve_A = {{0, 5, 0}, {0, -5, 0}},
                   .sideways_A = Vector3d(1, 0, 0)});
  test::run(world, 0.2);
  EXPECT_NEAR(world.pose(id).t.x(), 1.4, 1e-6);
  EXPECT_NEAR(world.pose(id).t.y(), -4, 1e-6);
  EXPECT_NEAR(world.pose(id).t.z(), 0, 1e-3);
}

TEST(Joint, AMovedBodyCarriesItsAttachedBodies) {
  RigidWorld world(test::weightless());
  DynamicBody hand;
  hand.motion = {{10, 0, 0}, {0, 0, 1}};
  const int a = world.add_body(hand);
  const int b = world.add_body(test::ghost(hanging_plank, test::at(6, 0, 0)));
  world.add_joint({.kind = Kind::fixed, .a = a, .b = b, .X_AB = test::at(6, 0, 0)});
  double error = 0;
  for (int k = 0; k < 1000; ++k) error = std::max(error, world.step().joint_error_mm);
  EXPECT_LT(error, 0.02);
  EXPECT_NEAR(world.pose(a).t.x(), 10, 1e-9);
  EXPECT_NEAR(rotation_angle(world.pose(b)), 1, 1e-3);
}

TEST(Joint, OfInvalidValuesIsRefused) {
  RigidWorld world;
  const int a = world.add_body({}), b = world.add_body({});
  const int c = world.add_body(test::ghost(hanging_plank));
  EXPECT_THROW(world.add_joint({.a = a, .b = b}), InputError);  // neither is free
  EXPECT_THROW(world.add_joint({.a = c, .b = c}), InputError);
  EXPECT_THROW(world.add_joint({.kind = Kind::guide, .a = a, .b = c}), InputError);
  EXPECT_THROW(world.add_joint({.kind = Kind::hinge, .a = a, .b = c, .axis_A = Vector3d::Zero()}),
               InputError);
}

}  // namespace
}  // namespace condyle
