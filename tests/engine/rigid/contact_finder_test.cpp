#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/engine/rigid/scene.h"
#include "tests/support/overlap_oracle.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A flat plate whose top is the plane z = 0.
TriMesh plate(double half_x = 12, double half_y = 10) {
  return test::box({-half_x, -half_y, -3}, {half_x, half_y, 0});
}

/// Continues and returns the largest displacement of the bodies from the start, and between two
/// steps.
struct Rest {
  double drift_mm = 0, jitter_mm = 0;
};
Rest rest(RigidWorld& world, double seconds) {
  Rest out;
  std::vector<Pose> start, last;
  for (int i = 0; i < world.body_count(); ++i) start.push_back(world.pose(i));
  last = start;
  for (int k = 0; k < static_cast<int>(std::lround(seconds * 1000)); ++k) {
    world.step();
    for (int i = 0; i < world.body_count(); ++i) {
      const auto n = static_cast<std::size_t>(i);
      out.drift_mm = std::max(out.drift_mm, test::apart(start[n], world.pose(i)));
      out.jitter_mm = std::max(out.jitter_mm, test::apart(last[n], world.pose(i)));
      last[n] = world.pose(i);
    }
  }
  return out;
}

double total_push(const RigidWorld& world) {
  double sum = 0;
  for (const auto& contact : world.contacts()) sum += contact.push_N * contact.normal.z();
  return sum;
}

TEST(SurfaceContact, ABlockOnAPlaneRestsWithoutDrift) {
  RigidWorld world;
  const int floor = world.add_body(test::fixed(plate()));
  const int block =
      world.add_body(test::solid(test::box({-4, -4, 0}, {4, 4, 6}), test::at(0, 0, 0.5)));
  world.add_pair({.a = floor, .b = block, .friction = 0.3});
  test::run(world, 0.5);
  EXPECT_NEAR(world.pose(block).t.z(), -0.01, 0.01);  // half the slop deep
  const Rest r = rest(world, 10);
  EXPECT_LT(r.drift_mm, 1e-6);
  EXPECT_LT(r.jitter_mm, 1e-9);
  EXPECT_NEAR(total_push(world), world.mass(block).mass_kg * 9.81, 1e-9);
}

TEST(SurfaceContact, AGraftPressedOnABumpyBoneRestsWithoutDrift) {
  const TriMesh bone = test::sphere(5, 20, {0, 0, 0}, 0.03),
                graft = test::box({-8, -3, -1}, {8, 3, 1});
  RigidWorld world;
  const int a = world.add_body(test::fixed(bone));
  const int b = world.add_body(test::solid(graft, test::turned({1, 2, 1}, 12, {1, 1, 24})));
  world.add_pair({.a = a, .b = b, .friction = 0.4});
  world.add_force({.body = b, .force_N = {0, 0, -2}});
  test::run(world, 1);
  EXPECT_FALSE(world.contacts().empty());
  const Rest r = rest(world, 10);
  EXPECT_LT(r.drift_mm, 0.01);
  EXPECT_LT(r.jitter_mm, 1e-6);
  EXPECT_LT(deepest(test::OverlapOracle(bone), test::OverlapOracle(graft), world.pose(b)), 0.05);
}

TEST(SurfaceContact, FrictionHoldsBelowItsCoefficientAndSlidesAboveWithTheRightAcceleration) {
  const auto floor_of = test::surface(test::box({-8, -6, -2}, {60, 6, 0}));
  const TriMesh mesh = test::box({-4, -4, 0}, {4, 4, 3});
  const auto block_of = test::surface(mesh);
  const double friction = 0.3;
  for (const double fraction : {0.5, 0.98, 1.02, 1.5, 2.5}) {  // of the slope that friction holds
    const double slope = std::atan(fraction * friction);
    RigidSettings settings;
    settings.gravity_mm_s2 = 9810 * Vector3d(std::sin(slope), 0, -std::cos(slope));
    RigidWorld world(settings);
    DynamicBody plane;
    plane.surfaces = {floor_of};
    const int floor = world.add_body(plane);
    const int block = world.add_body(test::solid(mesh, test::at(0, 0, 0), block_of));
    world.add_pair({.a = floor, .b = block, .friction = friction});
    test::run(world, 0.05);
    const double speed = world.motion(block).velocity.x(), place = world.pose(block).t.x();
    test::run(world, 0.1);
    const double acceleration = (world.motion(block).velocity.x() - speed) / 0.1;
    if (fraction < 1) {
      EXPECT_NEAR(world.pose(block).t.x(), place, 1e-6) << fraction;
    } else {
      const double expected = 9810 * (std::sin(slope) - friction * std::cos(slope));
      EXPECT_NEAR(acceleration / expected, 1, 0.03) << fraction;
    }
    EXPECT_NEAR(world.motion(block).velocity.y(), 0, 1e-3);
  }
}

TEST(SurfaceContact, AFallEndsWithoutABounceAndEnergyNeverGrows) {
  for (const double tilt : {0.0, 30.0}) {
    RigidWorld world;
    const int floor = world.add_body(test::fixed(plate()));
    const int block = world.add_body(
        test::solid(test::box({-3, -3, -3}, {3, 3, 3}), test::turned({2, 1, 0}, tilt, {0, 0, 15})));
    world.add_pair({.a = floor, .b = block, .friction = 0.3});
    const double weight = world.mass(block).mass_kg * 9.81;
    double before = world.kinetic_energy() + world.potential_energy(), growth = 0;
    const double at_start = before;
    for (int k = 0; k < 1000; ++k) {
      world.step();
      const double energy = world.kinetic_energy() + world.potential_energy();
      growth = std::max(growth, energy - before);
      before = energy;
    }
    // Depenetration beyond the slop lifts the block in fractions of it.
    EXPECT_LT(growth, weight * 0.01) << tilt;
    EXPECT_LT(world.kinetic_energy(), 1e-9);
    EXPECT_NEAR(at_start - before, weight * (15 - world.pose(block).t.z()), 1e-6);
    EXPECT_NEAR(world.pose(block).t.z(), 3, 0.03) << tilt;
  }
}

TEST(SurfaceContact, CollisionsKeepMomentumAndLoseEnergy) {
  RigidWorld world(test::weightless());
  const TriMesh big = test::sphere(4, 5, {0, 0, 0}, 0.04),
                small = test::sphere(4, 4, {0, 0, 0}, 0.04);
  DynamicBody a = test::solid(big, test::at(0, 0, 0)), b = test::solid(small, test::at(14, 1.5, 1));
  a.motion = {{30, 0, 0}, {1, 2, 3}};
  b.motion = {{-250, 0, 0}, {5, -4, 2}};
  world.add_pair({.a = world.add_body(a), .b = world.add_body(b), .friction = 0.4});
  const Vector3d p = world.momentum(), L = world.angular_momentum();
  const double start = world.kinetic_energy();
  double last = start;
  int touching = 0;
  for (int k = 0; k < 200; ++k) {
    world.step();
    EXPECT_LE(world.kinetic_energy(), last * (1 + 1e-5));  // the tumbling's own error
    last = world.kinetic_energy();
    touching += !world.contacts().empty();
  }
  EXPECT_GT(touching, 0);
  EXPECT_LT(last, 0.5 * start);
  EXPECT_LT((world.momentum() - p).norm(), 1e-12 * p.norm());
  EXPECT_LT((world.angular_momentum() - L).norm(), 1e-9 * L.norm());
}

TEST(SurfaceContact, APushGoesThroughARowOfBlocks) {
  RigidWorld world;
  const int floor = world.add_body(test::fixed(test::box({-5, -5, -2}, {45, 5, 0})));
  const TriMesh mesh = test::box({-3, -3, 0}, {3, 3, 5});
  const auto block_of = test::surface(mesh);
  std::vector<int> blocks;
  for (int i = 0; i < 5; ++i) {
    blocks.push_back(world.add_body(test::solid(mesh, test::at(6.4 * i, 0, 0), block_of)));
    world.add_pair({.a = floor, .b = blocks.back(), .friction = 0.3});
    if (i > 0) world.add_pair({.a = blocks[i - 1], .b = blocks[i], .friction = 0.2});
  }
  const double held = 5 * 0.3 * world.mass(blocks[0]).mass_kg * 9.81;  // by friction, all five
  const int push = world.add_force({.body = blocks[0], .point = {-3, 0, 0.2}});
  world.set_force(push, {0.9 * held, 0, 0});
  test::run(world, 1);
  EXPECT_NEAR(world.pose(blocks[1]).t.x() - world.pose(blocks[0]).t.x(), 6, 0.03);
  EXPECT_LT(rest(world, 0.5).drift_mm, 1e-3);
  world.set_force(push, {1.3 * held, 0, 0});
  double depth = 0;
  for (int k = 0; k < 80; ++k) depth = std::max(depth, world.step().depth_mm);
  for (int i = 0; i < 5; ++i) EXPECT_GT(world.motion(blocks[i]).velocity.x(), 30);
  for (int i = 1; i < 5; ++i)
    EXPECT_NEAR(world.pose(blocks[i]).t.x() - world.pose(blocks[i - 1]).t.x(), 6, 0.03);
  // All five as one: a fraction 0.3 of what friction holds is left to drive them.
  EXPECT_NEAR(world.motion(blocks[4]).velocity.x(), 0.3 * 0.3 * 9810 * 0.08, 5);
  EXPECT_LT(depth, 0.05);
}

TEST(SurfaceContact, AStackStands) {
  RigidWorld world;
  int below = world.add_body(test::fixed(plate()));
  const TriMesh mesh = test::box({-3, -3, 0}, {3, 3, 4});
  const auto block_of = test::surface(mesh);
  for (int i = 0; i < 4; ++i) {
    const int block = world.add_body(test::solid(mesh, test::at(0.2 * i, 0, 4.05 * i), block_of));
    world.add_pair({.a = below, .b = block, .friction = 0.3});
    below = block;
  }
  test::run(world, 1);
  EXPECT_NEAR(world.pose(below).t.z(), 12, 0.1);
  EXPECT_LT(rest(world, 2).drift_mm, 0.01);
}

TEST(SurfaceContact, AStartThatOverlapsIsPartedGently) {
  RigidWorld world;
  const int floor = world.add_body(test::fixed(plate()));
  const int ball = world.add_body(test::solid(test::sphere(4, 5), test::at(0, 0, 4.4)));
  world.add_pair({.a = floor, .b = ball, .friction = 0.3});
  double fastest = 0;
  for (int k = 0; k < 300; ++k) {
    EXPECT_TRUE(world.step().taken);
    fastest = std::max(fastest, world.motion(ball).velocity.norm());
  }
  EXPECT_NEAR(world.pose(ball).t.z(), 4.98, 0.02);
  EXPECT_LT(fastest, 20);  // it only falls by what the facets permit
}

TEST(SurfaceContact, AllowedOverlapRemainsButDoesNotDeepen) {
  RigidWorld world;
  const int floor = world.add_body(test::fixed(plate()));
  const int block =
      world.add_body(test::solid(test::box({-4, -4, -0.4}, {4, 4, 4}), test::at(0, 0, 0)));
  const int pair = world.add_pair({.a = floor, .b = block, .friction = 0.3});
  world.allow_overlap(pair);
  test::run(world, 0.5);
  EXPECT_NEAR(world.pose(block).t.z(), 0, 0.03);
  EXPECT_NEAR(total_push(world), world.mass(block).mass_kg * 9.81, 1e-6);
}

TEST(SurfaceContact, AroundAllowedOverlapThereIsNoContactFartherOffThereIs) {
  for (const double around_mm : {3.0, 0.0}) {
    RigidWorld world;
    const int floor = world.add_body(test::fixed(plate(24)));
    DynamicBody two = test::solid(test::box({-20, -2, -0.4}, {-16, 2, 4}), test::at(0, 0, 0));
    two.surfaces.push_back(
        test::solid(test::box({16, -2, 0.5}, {20, 2, 4}), test::at(0, 0, 0)).surfaces[0]);
    const int block = world.add_body(two);
    world.allow_overlap(world.add_pair({.a = floor, .b = block, .friction = 0}), around_mm);
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(world.step().taken);
    const double left = (world.pose(block) * Eigen::Vector3d(-18, 0, -0.4)).z(),
                 right = (world.pose(block) * Eigen::Vector3d(18, 0, 0.5)).z();
    if (around_mm > 0)
      EXPECT_LT(left, -0.6) << "it sinks in where it overlapped";
    else
      EXPECT_NEAR(left, -0.4, 0.03);
    EXPECT_GT(right, -0.03) << around_mm;
  }
}

TEST(SurfaceContact, AGapIsKept) {
  RigidWorld world;
  const int floor = world.add_body(test::fixed(plate()));
  const int block =
      world.add_body(test::solid(test::box({-4, -4, 0}, {4, 4, 4}), test::at(0, 0, 1)));
  world.add_pair({.a = floor, .b = block, .gap_mm = 0.4});
  test::run(world, 0.5);
  EXPECT_NEAR(world.pose(block).t.z(), 0.4, 0.03);
  EXPECT_THROW(world.add_pair({.a = floor, .b = block, .gap_mm = 0.9}), InputError);  // band 1 mm
  EXPECT_THROW(world.add_pair({.a = floor, .b = block, .friction = -1}), InputError);
}

TEST(SurfaceContact, AFastBodyDoesNotPassThroughAThinWall) {
  RigidWorld world(test::weightless());
  const int wall = world.add_body(test::fixed(test::box({-8, -8, -0.6}, {8, 8, 0})));
  DynamicBody body = test::solid(test::sphere(3, 3), test::at(0.3, 0.2, 30));
  body.motion.velocity = {0, 0, -9000};  // 15 times the wall's thickness in a step
  const int ball = world.add_body(body);
  world.add_pair({.a = wall, .b = ball});
  int parts = 0;
  for (int k = 0; k < 20; ++k) parts = std::max(parts, world.step().parts);
  EXPECT_GT(parts, 4);
  EXPECT_NEAR(world.pose(ball).t.z(), 3, 0.05);
}

TEST(SurfaceContact, AMovedBodyPushesAndDrags) {
  RigidWorld world;
  DynamicBody belt = test::fixed(test::box({-10, -6, -2}, {40, 6, 0}));
  belt.motion.velocity = {-50, 0, 0};
  const int a = world.add_body(belt);
  const int block =
      world.add_body(test::solid(test::box({-3, -3, 0}, {3, 3, 3}), test::at(20, 0, 0)));
  world.add_pair({.a = a, .b = block, .friction = 0.3});
  test::run(world, 0.3);
  EXPECT_NEAR(world.motion(block).velocity.x(), -50, 1e-3);
}

/// A scene of everything: falling bodies, a joint and a spring.
RigidWorld busy_world(const std::shared_ptr<const ContactSurface>& bumpy, const TriMesh& mesh,
                      const std::shared_ptr<const ContactSurface>& ground) {
  RigidWorld world;
  DynamicBody floor;
  floor.surfaces = {ground};
  const int a = world.add_body(floor);
  const int b = world.add_body(test::solid(mesh, test::turned({1, 0, 2}, 20, {0, 0, 7}), bumpy));
  const int c = world.add_body(test::solid(mesh, test::turned({0, 3, 1}, 40, {2, 1, 17}), bumpy));
  world.add_pair({.a = a, .b = b, .friction = 0.3});
  world.add_pair({.a = a, .b = c, .friction = 0.3});
  world.add_pair({.a = b, .b = c, .friction = 0.3});
  world.add_joint({.kind = RigidJoint::Kind::guide,
                   .a = a,
                   .b = b,
                   .p_B = {0, 0, 0},
                   .curve_A = {{-4, 0, 0}, {0, 0, 0.5}, {4, 0, 0}},
                   .sideways_A = Vector3d(0, 0, 1)});
  world.add_spring({.a = b, .b = c, .rest_length_mm = 9, .stiffness_N_mm = 0.01});
  return world;
}

bool same_bits(const RigidWorld& x, const RigidWorld& y) {
  for (int i = 0; i < x.body_count(); ++i)
    if (x.pose(i).t != y.pose(i).t || x.pose(i).R.coeffs() != y.pose(i).R.coeffs() ||
        x.motion(i).velocity != y.motion(i).velocity || x.motion(i).spin != y.motion(i).spin)
      return false;
  return true;
}

TEST(SurfaceContact, IsBitIdenticalOnTwoThreadsAndFromAnySavedState) {
  const TriMesh mesh = test::sphere(4, 4, {0, 0, 0}, 0.06);
  const auto bumpy = test::surface(mesh), ground = test::surface(plate());
  RigidWorld one = busy_world(bumpy, mesh, ground), two = busy_world(bumpy, mesh, ground),
             again = busy_world(bumpy, mesh, ground);
  RigidState midway;
  std::size_t touching = 0;
  for (int k = 0; k < 600; ++k) {
    if (k == 150) midway = one.state();
    one.step(1);
    two.step(2);
    touching += one.contacts().size();
    ASSERT_TRUE(same_bits(one, two)) << k;
  }
  EXPECT_GT(touching, 1000u);
  EXPECT_FALSE(midway.contact_forces.empty());
  again.set_state(midway);
  for (int k = 150; k < 600; ++k) again.step(1);
  EXPECT_TRUE(same_bits(one, again));
  EXPECT_THROW(RigidWorld().set_state(midway), InputError);
}

TEST(SurfaceContact, TurnedSceneGivesTheTurnedAnswer) {
  std::mt19937_64 random(52);
  const TriMesh floor = plate(), mesh = test::box({-4, -3, -2}, {4, 3, 2});
  const Pose start = test::turned({1, 2, 0}, 15, {0, 0, 6});
  const auto settle = [&](const Pose& X) {
    RigidSettings settings;
    settings.gravity_mm_s2 = X.R * Vector3d(0, 0, -9810);
    RigidWorld world(settings);
    const int a = world.add_body(test::fixed(floor, X));
    const int b = world.add_body(test::solid(mesh, X * start));
    world.add_pair({.a = a, .b = b, .friction = 0.6});
    test::run(world, 0.6);
    return X.inverse() * world.pose(b);
  };
  const Pose straight = settle({});
  for (int k = 0; k < 3; ++k) {
    const Pose other = settle(test::any_pose(random, 30));
    EXPECT_NEAR(other.t.z(), straight.t.z(), 0.01);
    EXPECT_LT(test::apart(straight, other), 0.3);  // impacts on edges are sensitive
  }
}

}  // namespace
}  // namespace condyle
