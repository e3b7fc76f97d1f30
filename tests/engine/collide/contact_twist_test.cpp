#include "engine/collide/contact_twist.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::vector<ContactRow> any_rows(std::mt19937_64& random, int count, double rotation_length_mm) {
  std::vector<ContactRow> rows;
  for (int i = 0; i < count; ++i) {
    const Vector3d normal = test::any_pose(random, 1).R * Vector3d::UnitX();
    rows.push_back(contact_row(test::any_pose(random, 20).t, normal,
                               std::uniform_real_distribution<double>(0, 0.3)(random),
                               rotation_length_mm));
  }
  return rows;
}

Twist any_twist(std::mt19937_64& random) {
  Twist x;
  x << test::any_pose(random, 2).t, test::any_pose(random, 2).t;
  return x;
}

TEST(NearestAllowed, FulfilsTheConditionsOfTheNearestPoint) {
  std::mt19937_64 random(11);
  int held = 0;
  for (int k = 0; k < 300; ++k) {
    const auto rows = any_rows(random, 200, 15);
    const Twist requested = any_twist(random);
    const TwistSettings settings{.rotation_length_mm = 15};
    const TwistSolution solution = nearest_allowed(requested, rows, settings);
    EXPECT_LE(solution.violation_mm, settings.tolerance_mm);
    // What keeps it off is a sum of pushes, each along a contact that is closed.
    Twist rest = solution.x - requested;
    for (const Push& push : solution.pushes) {
      EXPECT_GE(push.length_mm, 0);
      EXPECT_NEAR(rows[push.row].gap_mm + rows[push.row].along.dot(solution.x), 0,
                  settings.tolerance_mm);
      rest -= push.length_mm * rows[push.row].along;
      ++held;
    }
    EXPECT_LT(rest.norm(), 1e-7);
    EXPECT_LE(solution.pushes.size(), 6u);
  }
  EXPECT_GT(held, 300);
}

TEST(NearestAllowed, RelaxationAgreesWithTheExactAnswer) {
  std::mt19937_64 random(12);
  double apart = 0;
  for (int k = 0; k < 50; ++k) {
    const auto rows = any_rows(random, 20, 15);
    const Twist requested = 0.2 * any_twist(random);
    // No row rubs: the solver of friction solves the same problem.
    const Twist exact = nearest_allowed(requested, rows, {.rotation_length_mm = 15}).x;
    const Twist relaxed =
        nearest_allowed(requested, rows, {.friction = 0.5, .rotation_length_mm = 15}).x;
    apart = std::max(apart, (exact - relaxed).norm());
    EXPECT_GT(requested.norm(), 0.01);
  }
  EXPECT_LE(apart, 0.02);
}

TEST(NearestAllowed, FreeMotionIsCompleted) {
  std::mt19937_64 random(13);
  const Twist requested = any_twist(random);
  auto rows = any_rows(random, 50, 10);
  for (auto& row : rows) row.gap_mm = 100;
  EXPECT_EQ(nearest_allowed(requested, rows, {}).x, requested);
  EXPECT_EQ(nearest_allowed(requested, {}, {.friction = 0.3}).x, requested);
}

TEST(NearestAllowed, PointSticksWithinTheConeOfFrictionAndSlidesBeyond) {
  std::mt19937_64 random(14);
  for (int k = 0; k < 50; ++k) {
    const Pose turn = test::any_pose(random, 1);
    const Vector3d n = turn.R * Vector3d::UnitZ(), t = turn.R * Vector3d::UnitX();
    ContactRow row = contact_row(Vector3d::Zero(), n, 0, 10);
    row.rubs = true;
    const double mu = 0.4, press = 0.2;
    for (const double sideways : {0.5, 0.9, 1.1, 2.0}) {  // times what friction holds
      Twist requested = Twist::Zero();
      requested.head<3>() = -press * n + sideways * mu * press * t;
      const Twist x =
          nearest_allowed(requested, {row}, {.friction = mu, .rotation_length_mm = 10}).x;
      const double slip = std::max(0.0, sideways - 1) * mu * press;
      EXPECT_NEAR(x.head<3>().dot(t), slip, 1e-4);
      EXPECT_NEAR(x.head<3>().dot(n), 0, 1e-3);
    }
  }
}

TEST(NearestAllowed, WithoutAnyAllowedMotionTheResidualIsReported) {
  const std::vector<ContactRow> rows = {contact_row({0, 0, 0}, Vector3d::UnitX(), -0.1, 10),
                                        contact_row({0, 0, 0}, -Vector3d::UnitX(), -0.1, 10)};
  EXPECT_GE(nearest_allowed(Twist::Zero(), rows, {}).violation_mm, 0.1);
  EXPECT_LT(nearest_allowed(Twist::Zero(), rows, {}).x.norm(), 1);
}

}  // namespace
}  // namespace condyle
