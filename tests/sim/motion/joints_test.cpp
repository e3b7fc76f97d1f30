// Laws of the four inputs.
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "sim/motion/condylar_kinematics.h"
#include "sim/motion/jaw_joints.h"
#include "tests/sim/motion/jaws.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

/// Inputs spread over what a jaw can do.
std::vector<JawInputs> many_inputs(const JawJoints& joints) {
  std::vector<JawInputs> all;
  for (const double theta : {-0.05, 0.0, 0.2, 0.6})
    for (const double left : {-0.7, 0.0, 3.0, 11.0})
      for (const double right : {0.0, 1.5, 9.0, 16.0})
        all.push_back({theta, left, right, joints.bennett_shift_mm(left, right)});
  return all;
}

}  // namespace

TEST(JawJoints, CondylesKeepTheirDistanceAndAdvanceAsRequested) {
  Case patient = free_jaw();
  patient.landmarks.points["left_condyle"] += Vector3d(1.5, 2, -1);  // no jaw is symmetric
  const JawJoints joints(patient, {}, JointReach::straight, 1);
  const Vector3d left = joints.condyle(JawSide::left), right = joints.condyle(JawSide::right);
  for (const auto& in : many_inputs(joints)) {
    const Pose X_CM = joints.pose(in);
    EXPECT_NEAR((X_CM * left - X_CM * right).norm(), (left - right).norm(), 1e-9);
    EXPECT_NEAR(left.y() - (X_CM * left).y(), in.left_mm, 1e-9);
    EXPECT_NEAR(right.y() - (X_CM * right).y(), in.right_mm, 1e-9);
    EXPECT_NEAR(left.z() - (X_CM * left).z(),
                joints.inferior_translation_mm(JawSide::left, in.left_mm), 1e-9);
  }
  EXPECT_LT(joints.pose({}).t.norm(), 1e-12);
}

TEST(JawJoints, OrbitingCondyleMovesMediallyByBennettAngleAndSideShift) {
  const JawJoints joints(free_jaw(), {.bennett_deg = 10, .side_shift_mm = 0.6},
                         JointReach::straight, 1);
  for (const double s : {4.0, 8.0, 12.0}) {
    const double expected = 0.6 * (1 - std::exp(-s)) + s * std::tan(10 * degree);
    const Vector3d left = joints.condyle(JawSide::left), right = joints.condyle(JawSide::right);
    const Pose to_right = joints.pose({0, s, 0, joints.bennett_shift_mm(s, 0)});
    EXPECT_NEAR(left.x() - (to_right * left).x(), expected, 1e-9);
    const Pose to_left = joints.pose({0, 0, s, joints.bennett_shift_mm(0, s)});
    EXPECT_NEAR((to_left * right).x() - right.x(), expected, 1e-9);
  }
  EXPECT_EQ(joints.bennett_shift_mm(5, 5), 0);
}

TEST(JawJoints, TenMillimetresOfOneCondyleYawTheJawByAboutFiveDegrees) {
  const MotionParameters level = {
      .inclination_left_deg = 0, .inclination_right_deg = 0, .bennett_deg = 0, .side_shift_mm = 0};
  const JawJoints joints(free_jaw(), level, JointReach::straight, 1);
  const Pose X_CM = joints.pose({0, 10, 0, 0});
  const Vector3d across = X_CM.R * Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(-across.y(), across.x()) / degree, 5.6, 0.2);
  EXPECT_NEAR((X_CM * joints.incisor()).x() - joints.incisor().x(), -7.7, 0.5);
}

TEST(JawJoints, PosesChangeSmoothlyWhereTheOrbitingSideChanges) {
  const JawJoints joints(free_jaw(), {}, JointReach::straight, 1);
  const auto incisor = [&](double ahead) {
    const double left = 5 + 0.5 * ahead, right = 5 - 0.5 * ahead;
    return joints.incisor({0.1, left, right, joints.bennett_shift_mm(left, right)});
  };
  for (const double h : {1e-2, 1e-3, 1e-4})
    EXPECT_LT((incisor(h) - 2 * incisor(0) + incisor(-h)).norm(), 3 * h * h + 1e-12) << h;
}

TEST(JawJoints, GivenInclinationIsTheSecantOfFiveMillimetresOnEachSide) {
  for (const double shape : {0.0, 0.4, 1.0}) {
    const JawJoints joints(
        jaw_in_fossae(),
        {.inclination_left_deg = 30, .inclination_right_deg = 52, .path_shape = shape},
        JointReach::straight, 1);
    EXPECT_NEAR(joints.inclination_deg(JawSide::left), 30, 1e-6);
    EXPECT_NEAR(joints.inclination_deg(JawSide::right), 52, 1e-6);
    EXPECT_NEAR(joints.inferior_translation_mm(JawSide::left, 5), 5 * std::tan(30 * degree), 1e-6);
  }
}

TEST(JawJoints, CondylesInAFossaKeepTheDiscGapEverywhere) {
  const JawJoints joints(jaw_in_fossae(), {.disc_gap_front_mm = 1.3}, JointReach::aside, 2);
  ASSERT_TRUE(joints.surfaces());
  TrianglePair left, right;
  for (const double theta : {0.0, 0.3, 0.6})
    for (double s = 7; s <= 15; s += 0.7) {
      const double shift = joints.bennett_shift_mm(s, 0);
      const Pose X_CM = joints.pose({theta, s, 0, shift});
      EXPECT_NEAR(joints.surfaces()->gap_mm(JawSide::left, X_CM, left), 1.3, 0.1) << s;
      const Pose both = joints.pose({theta, s, s, 0});
      EXPECT_NEAR(joints.surfaces()->gap_mm(JawSide::right, both, right), 1.3, 0.1) << s;
    }
}

TEST(JawJoints, SeatsAreTheSameForOneAndTwoThreads) {
  const JawJoints one(jaw_in_fossae(), {}, JointReach::aside, 1);
  const JawJoints two(jaw_in_fossae(), {}, JointReach::aside, 2);
  for (double s = 0.3; s < 17; s += 1.1)
    EXPECT_EQ(one.inferior_translation_mm(JawSide::left, s, 0.3, 0.4),
              two.inferior_translation_mm(JawSide::left, s, 0.3, 0.4));
}

TEST(JawJoints, ImportedJointsKeepTheirMeasuredGap) {
  const auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const JawJoints joints(*patient, {}, JointReach::straight, 2);
  ASSERT_TRUE(joints.surfaces());
  const double rest = joints.surfaces()->rest_gap_mm(JawSide::left);
  TrianglePair start;
  for (double s = 4; s <= 9; s += 0.5)
    EXPECT_NEAR(joints.surfaces()->gap_mm(JawSide::left, joints.pose({0.03, s, s, 0}), start), rest,
                0.1)
        << s;
}

TEST(JawJoints, BonwillAndBalkwillLocateTheCondyles) {
  const Case patient = free_jaw();
  const JawJoints own(patient, {}, JointReach::straight, 1);
  const Vector3d across = own.condyle(JawSide::left) - own.incisor();
  EXPECT_NEAR(own.bonwill_mm(), across.norm(), 1e-9);
  const JawJoints placed(patient, {.bonwill_mm = 110, .balkwill_deg = 22}, JointReach::straight, 1);
  EXPECT_NEAR(placed.bonwill_mm(), 110, 1e-9);
  EXPECT_NEAR(placed.balkwill_deg(), 22, 1e-9);
  EXPECT_NEAR((placed.condyle(JawSide::left) - placed.condyle(JawSide::right)).norm(), 101, 1e-9);
  Case unmarked = patient;
  unmarked.landmarks.points.erase("left_condyle");
  EXPECT_THROW(JawJoints(unmarked, {}, JointReach::straight, 1), InputError);
  EXPECT_NEAR(JawJoints(unmarked, {.bonwill_mm = 104}, JointReach::straight, 1).bonwill_mm(), 104,
              1e-9);
}

}  // namespace condyle::test
