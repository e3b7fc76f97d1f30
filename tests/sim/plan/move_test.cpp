#include "sim/plan/move.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "tests/sim/plan/marks.h"

using namespace condyle;
using Eigen::Vector3d;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double endless = std::numeric_limits<double>::infinity();

const Vector3d u1(0, -95, -53);

std::string move_refusal(const ClinicalMove& move) {
  try {
    move_pose(move, {}, u1);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the move was accepted";
  return "";
}

ClinicalFrame turned_frame() {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(0.2, Vector3d::UnitX()) *
                             Eigen::AngleAxisd(-0.1, Vector3d::UnitY()) *
                             Eigen::AngleAxisd(0.15, Vector3d::UnitZ()));
  return {
      .left = R * Vector3d::UnitX(), .back = R * Vector3d::UnitY(), .up = R * Vector3d::UnitZ()};
}

}  // namespace

TEST(ClinicalMove, NoMoveIsExactlyTheIdentity) {
  const Pose X = move_pose({}, turned_frame(), u1);
  EXPECT_EQ(X.R.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_EQ(X.t, Vector3d::Zero());
}

TEST(ClinicalMove, WordsAreThePatientsDirections) {
  EXPECT_EQ(move_pose({.forward_mm = 4, .up_mm = 2}, {}, u1) * u1, Vector3d(0, -99, -51));
  EXPECT_EQ(move_pose({.left_mm = -3}, {}, u1) * u1, Vector3d(-3, -95, -53));
}

// Each sense of rotation as in the words: a point on a lever of 10 mm, by 30 degrees.
TEST(ClinicalMove, SensesOfRotation) {
  const double c = 10 * std::cos(30 * degree), s = 5;
  const auto turned = [](const ClinicalMove& move, const Vector3d& arm) {
    return Vector3d(move_pose(move, {}, u1) * (u1 + arm) - u1);
  };
  const auto expect = [](const Vector3d& a, const Vector3d& b) {
    EXPECT_NEAR((a - b).norm(), 0, 1e-12) << a.transpose();
  };
  const ClinicalMove pitch{.pitch_deg = 30}, yaw{.yaw_deg = 30}, roll{.roll_deg = 30};
  expect(turned(pitch, {0, -10, 0}), {0, -c, -s});  // front down
  expect(turned(pitch, {0, 10, 0}), {0, c, s});     // back up
  expect(turned(pitch, {0, 0, -10}), {0, s, -c});   // chin back
  expect(turned(yaw, {0, -10, 0}), {s, -c, 0});     // front to the left
  expect(turned(roll, {10, 0, 0}), {c, 0, -s});     // left side down
  expect(turned(roll, {-10, 0, 0}), {-c, 0, s});    // right side up
}

TEST(ClinicalMove, RollComesBeforePitchBeforeYaw) {
  const ClinicalMove move{.roll_deg = 20, .pitch_deg = 30, .yaw_deg = 40};
  const Eigen::Quaterniond R = Eigen::AngleAxisd(40 * degree, Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(30 * degree, Vector3d::UnitX()) *
                               Eigen::AngleAxisd(20 * degree, Vector3d::UnitY());
  EXPECT_LT(R.angularDistance(move_pose(move, {}, u1).R), 1e-12);
}

TEST(ClinicalMove, ThePointMovesByTheTranslationWhateverTheRotation) {
  const ClinicalFrame frame = turned_frame();
  const Pose X = move_pose(
      {.left_mm = 1, .forward_mm = 4, .up_mm = 2, .roll_deg = 5, .pitch_deg = -20, .yaw_deg = 11},
      frame, u1);
  const Vector3d expected = u1 + frame.left + 4 * frame.forward() + 2 * frame.up;
  EXPECT_NEAR((X * u1 - expected).norm(), 0, 1e-12);
}

TEST(ClinicalMove, APoseReadsBackAsItsWords) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> mm(-20, 20), deg(-30, 30);
  const ClinicalFrame frame = turned_frame();
  for (int i = 0; i < 200; ++i) {
    const ClinicalMove move{.about = "pns",
                            .left_mm = mm(random),
                            .forward_mm = mm(random),
                            .up_mm = mm(random),
                            .roll_deg = deg(random),
                            .pitch_deg = deg(random),
                            .yaw_deg = deg(random)};
    const Vector3d point(5 * mm(random), 5 * mm(random), 5 * mm(random));
    const ClinicalMove back = clinical_move(move_pose(move, frame, point), frame, point, "pns");
    EXPECT_EQ(back.about, "pns");
    EXPECT_NEAR(back.left_mm, move.left_mm, 1e-11);
    EXPECT_NEAR(back.forward_mm, move.forward_mm, 1e-11);
    EXPECT_NEAR(back.up_mm, move.up_mm, 1e-11);
    EXPECT_NEAR(back.roll_deg, move.roll_deg, 1e-11);
    EXPECT_NEAR(back.pitch_deg, move.pitch_deg, 1e-11);
    EXPECT_NEAR(back.yaw_deg, move.yaw_deg, 1e-11);
  }
}

// The paper's patient: upper incisors forward 4 and up 2, posterior nasal spine up 4.
TEST(ClinicalMove, PitchFromTwoHeights) {
  const Vector3d pns(0, -44, -27);
  const ClinicalMove move = with_height({.forward_mm = 4, .up_mm = 2}, {}, u1, pns, 4);
  const Pose X = move_pose(move, {}, u1);
  EXPECT_NEAR((X * pns - pns).z(), 4, 1e-12);
  EXPECT_NEAR((X * u1 - u1).z(), 2, 1e-12);
  EXPECT_NEAR((X * u1 - u1).y(), -4, 1e-12);
  EXPECT_NEAR(move.pitch_deg, std::asin(2.0 / 51) * degrees_per_radian, 0.03);
  // Points of equal height: asin((4 - 2) / 51) exactly.
  const ClinicalMove level = with_height({.up_mm = 2}, {}, u1, u1 + Vector3d(0, 51, 0), 4);
  EXPECT_NEAR(level.pitch_deg, std::asin(2.0 / 51) * degrees_per_radian, 1e-12);
}

TEST(ClinicalMove, PitchFromTwoHeightsInAnyFrameBesideOtherRotations) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  const ClinicalFrame frame = turned_frame();
  for (int i = 0; i < 100; ++i) {
    const ClinicalMove start{.forward_mm = 5 * any(random),
                             .up_mm = 5 * any(random),
                             .roll_deg = 8 * any(random),
                             .pitch_deg = 7,
                             .yaw_deg = 8 * any(random)};
    const Vector3d second =
        u1 + frame.vector({20 * any(random), 45 + 10 * any(random), 30 * any(random)});
    const double height = 6 * any(random);
    const ClinicalMove move = with_height(start, frame, u1, second, height);
    const Pose X = move_pose(move, frame, u1);
    EXPECT_NEAR(frame.up.dot(X * second - second), height, 1e-11);
    EXPECT_EQ(move.yaw_deg, start.yaw_deg);
    EXPECT_LT(std::abs(move.pitch_deg), 35);
  }
}

TEST(ClinicalMove, ImpossibleHeightsAreRefused) {
  EXPECT_THROW(with_height({}, {}, u1, u1 + Vector3d(0, 2, -30), 1), InputError);
  EXPECT_THROW(with_height({}, {}, u1, u1 + Vector3d(0, 50, 0), 51), InputError);
  EXPECT_THROW(with_height({}, {}, u1, u1 + Vector3d(0, 50, 0), 49), InputError);  // 79 degrees
  EXPECT_THROW(with_height({}, {}, u1, u1 + Vector3d(0, 50, 0), not_a_number), InputError);
}

TEST(ClinicalMove, ThePointIsNamed) {
  const Landmarks marks = test::upright_marks();
  const Vector3d middle(1, 2, 3);
  EXPECT_EQ(point_of({}, "maxilla", marks, middle), u1);
  EXPECT_EQ(point_of({}, "chin", marks, middle), marks.points.at("pogonion"));
  EXPECT_EQ(point_of({}, "proximal left", marks, middle), middle);
  EXPECT_EQ(point_of({.about = "pns"}, "maxilla", marks, middle), marks.points.at("pns"));
  EXPECT_EQ(point_of({.about = "centroid"}, "maxilla", marks, middle), middle);
  try {
    point_of({.about = "menton"}, "chin", marks, middle);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("menton"), std::string::npos);
  }
  EXPECT_THROW(point_of({}, "maxilla", {}, middle), InputError);
}

TEST(ClinicalMove, ImpossibleMovesAreRefusedWithTheirValue) {
  EXPECT_NE(move_refusal({.forward_mm = 200}).find("forward_mm is 200"), std::string::npos);
  EXPECT_NE(move_refusal({.up_mm = not_a_number}).find("up_mm"), std::string::npos);
  EXPECT_NE(move_refusal({.yaw_deg = -endless}).find("yaw_deg"), std::string::npos);
  EXPECT_NE(move_refusal({.roll_deg = 61}).find("roll_deg is 61"), std::string::npos);
  EXPECT_NE(move_refusal({.left_mm = 80, .up_mm = 80}).find("113.1 mm"), std::string::npos);
  EXPECT_NE(move_refusal({.roll_deg = 50, .yaw_deg = 50}).find("turns"), std::string::npos);
  EXPECT_NO_THROW(move_pose({.forward_mm = -100}, {}, u1));
  EXPECT_NO_THROW(move_pose({.pitch_deg = -60}, {}, u1));
}

TEST(ClinicalMove, ImpossiblePosesAreRefused) {
  const Pose far{Eigen::Quaterniond::Identity(), {0, 101, 0}};
  EXPECT_THROW(check_move(far, u1), InputError);
  const Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(61 * degree, Vector3d::UnitX())),
                    Vector3d::Zero()};
  EXPECT_THROW(check_rotation(turned), InputError);
  EXPECT_THROW(check_rotation({Eigen::Quaterniond(0.9, 0, 0, 0), Vector3d::Zero()}), InputError);
  EXPECT_THROW(check_rotation({Eigen::Quaterniond::Identity(), {not_a_number, 0, 0}}), InputError);
  // Far from the origin a small rotation has a large translation.
  const Vector3d there(0, 500, 0);
  const Pose small = move_pose({.yaw_deg = 30}, {}, there);
  EXPECT_GT(small.t.norm(), 200);
  EXPECT_NO_THROW(check_move(small, there));
}

TEST(ClinicalMove, Words) {
  EXPECT_EQ(move_words({.left_mm = -1, .forward_mm = 4, .up_mm = -0.04, .pitch_deg = 2.24}),
            "right 1.0, forward 4.0 mm; pitch 2.2 degrees, front down");
  EXPECT_EQ(move_words({.roll_deg = -1, .yaw_deg = 3}),
            "roll 1.0 degrees, right side down; yaw 3.0 degrees, front to the left");
  EXPECT_EQ(move_words({.forward_mm = 0.01}), "no move");
  EXPECT_EQ(in_words(-0.04, "up", "down"), "0.0");
  EXPECT_EQ(in_words(-12.34, "up", "down", 2), "12.34 down");
}
