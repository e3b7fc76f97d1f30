#include <gtest/gtest.h>

#include <limits>

#include "engine/core/error.h"
#include "tests/engine/rigid/scene.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const TriMesh plank = test::box({-1, -2, -4}, {1, 2, 4});

TEST(FreeBody, KeepsItsMomentaAndEnergyHoweverItTumbles) {
  // About its middle axis it flips over and over.
  RigidWorld world(test::weightless());
  DynamicBody body = test::ghost(plank, test::turned({1, 2, 3}, 50, {30, 20, 10}));
  body.motion = {{30, -40, 50}, body.X_WB.R * Vector3d(0.1, 20, 0.1)};
  const int id = world.add_body(body);
  const double energy = world.kinetic_energy();
  const Vector3d p = world.momentum(), L = world.angular_momentum();
  double off_energy = 0, off_L = 0, min_turn = 1;
  const Vector3d axis = body.X_WB.R * Vector3d::UnitY();
  for (int k = 0; k < 10000; ++k) {
    world.step();
    off_energy = std::max(off_energy, std::abs(world.kinetic_energy() / energy - 1));
    off_L = std::max(off_L, (world.angular_momentum() - L).norm() / L.norm());
    min_turn = std::min(min_turn, axis.dot(world.pose(id).R * Vector3d::UnitY()));
  }
  EXPECT_LT(min_turn, -0.9);  // it did flip
  EXPECT_LT(off_energy, 1e-4);
  EXPECT_LT(off_L, 1e-10);
  EXPECT_LT((world.momentum() - p).norm(), 1e-12 * p.norm());
  EXPECT_LT((world.pose(id).t - Vector3d(330, -380, 510)).norm(), 1e-6);
}

TEST(FreeBody, AThrowFollowsItsParabola) {
  RigidWorld world;
  DynamicBody body = test::ghost(plank);
  body.motion.velocity = {100, 0, 500};
  const int id = world.add_body(body);
  const double start = world.kinetic_energy() + world.potential_energy();
  test::run(world, 0.1);
  // Steps take the speed at their end: half a step's speed gained is the error.
  const double late = 0.5 * 9810 * 0.1 * 1e-3;
  EXPECT_NEAR(world.pose(id).t.x(), 10, 1e-9);
  EXPECT_NEAR(world.pose(id).t.z(), 50 - 0.5 * 9810 * 0.01 - late, 1e-9);
  EXPECT_NEAR(world.motion(id).velocity.z(), 500 - 981, 1e-9);
  const double drop = world.mass(id).mass_kg * 9.81 * late;
  EXPECT_NEAR(world.kinetic_energy() + world.potential_energy(), start - drop, 1e-12);
}

TEST(FreeBody, AForceAtAPointMovesTheCentreAndTurnsAboutIt) {
  RigidWorld world(test::weightless());
  const int id = world.add_body(test::ghost(plank));
  world.add_force({.body = id, .point = {0, 0, 4}, .force_N = {0.02, 0, 0}});
  world.step();
  const MassProperties& m = world.mass(id);
  EXPECT_NEAR(world.motion(id).velocity.x(), 1e3 * 0.02 * 1e-3 / m.mass_kg, 1e-9);
  EXPECT_NEAR(world.motion(id).spin.y(), 1e3 * 0.02 * 4 * 1e-3 / m.inertia(1, 1), 1e-9);
}

TEST(FreeBody, ABodyFixedForceTurnsWithIt) {
  RigidWorld world(test::weightless());
  const Pose X = test::turned({0, 0, 1}, 90, {0, 0, 0});
  const int id = world.add_body(test::ghost(plank, X));
  world.add_force({.body = id, .force_N = {0.01, 0, 0}, .frame = RigidForce::Frame::body});
  world.step();
  EXPECT_NEAR(world.motion(id).velocity.x(), 0, 1e-12);
  EXPECT_GT(world.motion(id).velocity.y(), 1);
}

TEST(FreeBody, DragSlowsItByItsLaw) {
  RigidWorld world(test::weightless());
  DynamicBody body = test::ghost(plank);
  body.motion.velocity = {100, 0, 0};
  const double m = body.mass.mass_kg;
  body.drag_N_s_mm = 0.5 * m / 1000 / 1e-3;  // c dt/m = 0.5
  const int id = world.add_body(body);
  world.step();
  world.step();
  EXPECT_NEAR(world.motion(id).velocity.x(), 25, 1e-9);
  body.drag_N_s_mm *= 3.8;
  const int swings = world.add_body(body);  // still below 2: it swings, and dies away
  for (int k = 0; k < 200; ++k) world.step();
  EXPECT_LT(std::abs(world.motion(swings).velocity.x()), 1e-2);
  body.drag_N_s_mm = 2.01 * m / 1000 / 1e-3;
  EXPECT_THROW(world.add_body(body), InputError);
}

TEST(FreeBody, DragAtAPointTurnsABodyAboutIt) {
  RigidWorld world(test::weightless());
  DynamicBody body = test::ghost(plank);
  body.motion.velocity = {0, 0, 100};
  body.drag_N_s_mm = 1e-3 * body.mass.mass_kg;  // slow against the step
  body.drag_at = body.mass.center + Vector3d(5, 0, 0);
  const int id = world.add_body(body);
  const auto there = [&] {
    const Vector3d arm = world.pose(id) * *body.drag_at - world.pose(id) * body.mass.center;
    return Vector3d(world.motion(id).velocity + world.motion(id).spin.cross(arm));
  };
  world.step();
  // The first pull: opposite to the point's velocity, with its lever arm.
  const double pull = 1000 * body.drag_N_s_mm * 100 * world.settings().step_s;
  EXPECT_NEAR(world.motion(id).velocity.z(), 100 - pull / body.mass.mass_kg, 1e-6);
  EXPECT_NEAR(world.motion(id).spin.y(), 5 * pull / body.mass.inertia(1, 1),
              1e-6 * std::abs(world.motion(id).spin.y()) + 1e-9);
  const double energy = world.kinetic_energy(), speed = there().norm();
  for (int k = 0; k < 200; ++k) world.step();
  EXPECT_LT(world.kinetic_energy(), energy);
  EXPECT_LT(there().norm(), speed);
}

TEST(FreeBody, ASpringSwingsAtItsFrequencyAndADamperLosesWhatItShould) {
  RigidWorld world(test::weightless());
  const int wall = world.add_body({});
  const TriMesh cube = test::box({-2, -2, -2}, {2, 2, 2});
  const int id = world.add_body(test::ghost(cube, test::at(12, 0, 0)));
  const double m = world.mass(id).mass_kg, omega = 40;
  const double k = m * omega * omega / 1000;
  world.add_spring({.a = wall, .b = id, .rest_length_mm = 10, .stiffness_N_mm = k});
  const double period = 2 * std::numbers::pi / omega;
  const double start = world.kinetic_energy() + world.potential_energy();
  double off = 0;
  int crossings = 0;
  bool outside = true;
  const int steps = static_cast<int>(10 * period / 1e-3);
  for (int s = 0; s < steps; ++s) {
    world.step();
    off = std::max(off, std::abs((world.kinetic_energy() + world.potential_energy()) / start - 1));
    const bool now_outside = world.pose(id).t.x() > 10;
    crossings += now_outside != outside;
    outside = now_outside;
  }
  EXPECT_EQ(crossings, 20);
  EXPECT_LT(off, 0.03);  // swings within each period, grows with omega dt
  EXPECT_THROW(world.add_spring({.a = wall, .b = id, .stiffness_N_mm = 2.1 * m / 1e-6 / 1000}),
               InputError);
  EXPECT_THROW(world.add_spring({.a = wall, .b = id, .damping_N_s_mm = 2.1 * m / 1e-3 / 1000}),
               InputError);
  world.add_spring({.a = wall, .b = id, .damping_N_s_mm = m * 20 / 1000});
  test::run(world, 1);
  EXPECT_NEAR(world.pose(id).t.x(), 10, 1e-3);
  EXPECT_LT(world.kinetic_energy(), 1e-8 * start);
}

TEST(FreeBody, ALigamentPullsButDoesNotPush) {
  RigidWorld world(test::weightless());
  const int wall = world.add_body({});
  DynamicBody body = test::ghost(plank, test::at(5, 0, 0));
  body.motion.velocity = {50, 0, 0};
  const int id = world.add_body(body);
  world.add_spring({.a = wall,
                    .b = id,
                    .rest_length_mm = 10,
                    .stiffness_N_mm = 0.0005,
                    .slack_when_short = true});
  test::run(world, 0.09);
  EXPECT_EQ(world.motion(id).velocity.x(), 50);
  test::run(world, 0.2);
  EXPECT_NEAR(world.motion(id).velocity.x(), -50, 1);
}

TEST(FreeBody, WhatIsNotFiniteOrTooLargeIsRefusedAndChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  RigidWorld world;
  const int id = world.add_body(test::ghost(plank));
  EXPECT_THROW(world.set_motion(id, {{nan, 0, 0}, {0, 0, 0}}), InputError);
  EXPECT_THROW(world.set_motion(id, {{1e6, 0, 0}, {0, 0, 0}}), InputError);
  EXPECT_THROW(world.set_pose(id, test::at(0, nan, 0)), InputError);
  EXPECT_THROW(world.add_force({.body = id, .force_N = {0, 0, nan}}), InputError);
  EXPECT_THROW(world.add_force({.body = id, .force_N = {0, 0, 1e9}}), InputError);
  EXPECT_THROW(world.add_force({.body = 7}), InputError);
  EXPECT_THROW(world.add_body({.mass = {.mass_kg = nan}}), InputError);
  EXPECT_THROW(world.add_body({.mass = {.mass_kg = 1}}), InputError);
  EXPECT_THROW(world.pose(2), InputError);
  EXPECT_THROW(RigidWorld({.step_s = nan}), InputError);
  // A force that is allowed but far too large for a body of a tenth of a gram.
  const int force = world.add_force({.body = id, .force_N = {5e4, 0, 0}});
  const auto step = world.step();
  EXPECT_FALSE(step.taken);
  EXPECT_EQ(world.pose(id).t, Vector3d::Zero());
  EXPECT_EQ(world.motion(id).velocity, Vector3d::Zero());
  world.set_force(force, {0, 0, 0});
  EXPECT_TRUE(world.step().taken);
}

}  // namespace
}  // namespace condyle
