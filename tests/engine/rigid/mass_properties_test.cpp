#include "engine/rigid/mass_properties.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "engine/core/error.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d box_inertia(double mass, const Vector3d& size) {
  const Vector3d s = size.cwiseProduct(size);
  return (mass / 12 * Vector3d(s.y() + s.z(), s.z() + s.x(), s.x() + s.y())).asDiagonal();
}

TEST(MassProperties, OfABoxInAnyPoseAreAnalytic) {
  std::mt19937_64 random(51);
  const Vector3d size(3, 5, 8);
  const TriMesh mesh = test::box({-1.5, -2.5, -4}, {1.5, 2.5, 4});
  const double density = 2e-6, mass = density * size.prod();
  for (int k = 0; k < 20; ++k) {
    const Pose X = test::any_pose(random, 200);
    const MassProperties m = mass_properties(test::moved(mesh, X), density);
    EXPECT_NEAR(m.mass_kg / mass, 1, 1e-12);
    EXPECT_LT((m.center - X.t).norm(), 1e-10);
    const Matrix3d R = X.R.toRotationMatrix();
    EXPECT_LT((m.inertia - R * box_inertia(mass, size) * R.transpose()).norm(), 1e-11 * mass * 100);
  }
}

TEST(MassProperties, OfASphereApproachTheAnalyticOnesAsItsMeshIsRefined) {
  const double r = 7, density = 1e-6;
  const double mass = density * 4 / 3 * std::numbers::pi * r * r * r;
  double last = 1;
  for (const int level : {2, 3, 4}) {
    const MassProperties m = mass_properties(test::sphere(level, r, {5, -3, 2}), density);
    const double error = std::abs(m.mass_kg / mass - 1);
    EXPECT_LT(error, 0.3 * last);
    last = error;
    EXPECT_LT((m.center - Vector3d(5, -3, 2)).norm(), 1e-6);
    const Matrix3d analytic = 0.4 * m.mass_kg * r * r * Matrix3d::Identity();
    EXPECT_LT((m.inertia - analytic).norm() / analytic.norm(), 2 * error);
  }
  EXPECT_LT(last, 0.01);
}

TEST(MassProperties, PartsSumToTheWhole) {
  const auto of = [](double low, double high) {
    return mass_properties(test::box({low, -2, 1}, {high, 3, 4}), 1e-6);
  };
  const MassProperties whole = of(-4, 9), sum = joined(of(-4, 1.5), of(1.5, 9));
  EXPECT_NEAR(sum.mass_kg, whole.mass_kg, 1e-15);
  EXPECT_LT((sum.center - whole.center).norm(), 1e-12);
  EXPECT_LT((sum.inertia - whole.inertia).norm(), 1e-12 * whole.inertia.norm());
}

TEST(MassProperties, ASurfaceThatEnclosesNothingIsRefused) {
  TriMesh inward = test::box({0, 0, 0}, {1, 1, 1});
  for (auto& t : inward.triangles) std::swap(t[0], t[1]);
  EXPECT_THROW(mass_properties(inward, 1e-6), InputError);
  EXPECT_THROW(mass_properties({}, 1e-6), InputError);
  EXPECT_THROW(mass_properties(test::box({0, 0, 0}, {1, 1, 1}), -1), InputError);
}

}  // namespace
}  // namespace condyle
