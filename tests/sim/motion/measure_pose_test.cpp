#include "sim/motion/measure_pose.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

TEST(Measures, AreZeroAtRestButForTheBite) {
  const Case patient = test::box_patient();
  const Measures rest = measure(patient, {});
  EXPECT_EQ(rest.opening_mm, 0);
  EXPECT_EQ(rest.rotation_deg, 0);
  EXPECT_EQ(rest.incisor, *patient.landmarks.find("lower_incisal_point"));
  EXPECT_EQ(rest.left_condyle, *patient.landmarks.find("left_condyle"));
  EXPECT_EQ(rest.right_condyle, *patient.landmarks.find("right_condyle"));
  EXPECT_NEAR(rest.interincisal_mm, std::sqrt(4 + 1), 1e-12);
}

TEST(Measures, FollowThePose) {
  const Case patient = test::box_patient();
  std::mt19937_64 random(1);
  for (int k = 0; k < 20; ++k) {
    const Pose X_CM = test::any_pose(random, 30);
    const Measures now = measure(patient, X_CM);
    const Eigen::Vector3d p = *patient.landmarks.find("lower_incisal_point");
    EXPECT_EQ(now.incisor, X_CM * p);
    EXPECT_DOUBLE_EQ(now.opening_mm, p.z() - (X_CM * p).z());
    EXPECT_NEAR((now.left_condyle - now.right_condyle).norm(), 96, 1e-9);
    EXPECT_NEAR(now.rotation_deg, Eigen::AngleAxisd(X_CM.R).angle() * 180 / std::numbers::pi, 1e-6);
  }
}

TEST(Measures, TurningAboutTheHelicalAxisAndSlidingAlongItIsThePose) {
  const Case patient = test::box_patient();
  std::mt19937_64 random(5);
  for (int k = 0; k < 50; ++k) {
    const Pose X_CM = test::any_pose(random, 30);
    const HelicalAxis axis = measure(patient, X_CM).helical_axis;
    ASSERT_TRUE(axis.known);
    EXPECT_NEAR(axis.direction.norm(), 1, 1e-12);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(rotation_angle(X_CM), axis.direction));
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(10, -80, 30)})
      EXPECT_LT(
          (axis.point + turn * (p - axis.point) + axis.slide_mm * axis.direction - X_CM * p).norm(),
          1e-8);
  }
  EXPECT_FALSE(
      measure(patient, Pose{Eigen::Quaterniond::Identity(), {3, 0, 0}}).helical_axis.known);
}

TEST(Measures, ExcursionsHaveTheirSigns) {
  const Case patient = test::box_patient();
  const Measures moved = measure(patient, Pose{Eigen::Quaterniond::Identity(), {2, -3, -4}});
  EXPECT_DOUBLE_EQ(moved.laterotrusion_mm, 2);  // to the patient's left
  EXPECT_DOUBLE_EQ(moved.protrusion_mm, 3);
  EXPECT_DOUBLE_EQ(moved.opening_mm, 4);
  EXPECT_DOUBLE_EQ(moved.left_condyle_travel_mm, std::sqrt(29.0));
  EXPECT_NEAR(moved.midline_deviation_mm - measure(patient, {}).midline_deviation_mm, 2, 1e-12);
}

TEST(Measures, OfAbsentLandmarksAreZeroNotNaN) {
  const Measures none = measure(Case{}, Pose{Eigen::Quaterniond::Identity(), {1, 2, 3}});
  EXPECT_EQ(none.incisor, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(none.opening_mm, 0);
  EXPECT_EQ(none.interincisal_mm, 0);
}

}  // namespace
}  // namespace condyle
