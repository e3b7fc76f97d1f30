#include "sim/plan/clinical_frame.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "tests/sim/plan/marks.h"

using namespace condyle;
using Eigen::Vector3d;

namespace {

void expect_axes(const ClinicalFrame& frame, const Eigen::Matrix3d& axes, double tolerance) {
  EXPECT_NEAR((frame.left - axes.col(0)).norm(), 0, tolerance) << frame.left.transpose();
  EXPECT_NEAR((frame.back - axes.col(1)).norm(), 0, tolerance) << frame.back.transpose();
  EXPECT_NEAR((frame.up - axes.col(2)).norm(), 0, tolerance) << frame.up.transpose();
}

std::string frame_refusal(const Landmarks& marks, const HeadReference& reference = {}) {
  try {
    clinical_frame(marks, reference);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the frame was found";
  return "";
}

const HeadReference natural_position = {.horizontal = Horizontal::natural_head_position};

}  // namespace

TEST(ClinicalFrame, AnUprightHeadHasTheAxesOfTheCase) {
  expect_axes(clinical_frame(test::upright_marks()), Eigen::Matrix3d::Identity(), 1e-15);
  expect_axes(clinical_frame(test::upright_marks(), natural_position), Eigen::Matrix3d::Identity(),
              1e-15);
}

TEST(ClinicalFrame, FrankfortTurnsWithTheHead) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-0.5, 0.5);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Quaterniond R = Eigen::AngleAxisd(angle(random), Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(angle(random), Vector3d::UnitX()) *
                                 Eigen::AngleAxisd(angle(random), Vector3d::UnitY());
    const Vector3d t(100 * angle(random), 300, -40);
    Landmarks marks = test::upright_marks();
    for (auto& [name, p] : marks.points) p = R * p + t;
    const ClinicalFrame frame = clinical_frame(marks);
    expect_axes(frame, R.toRotationMatrix(), 1e-13);
    EXPECT_GT(frame.left.dot(frame.back.cross(frame.up)), 0.999);
    EXPECT_EQ(frame.origin, marks.points["nasion"]);
  }
}

// The orbitales 79 mm in front of the porions and 10 mm lower: the plane slopes by
// atan(10 / 79) = 7.2 degrees downward in front.
TEST(ClinicalFrame, FrankfortFollowsTheOrbitales) {
  Landmarks marks = test::upright_marks();
  marks.points["left_orbitale"].z() = marks.points["right_orbitale"].z() = -10;
  const ClinicalFrame frame = clinical_frame(marks);
  EXPECT_NEAR(frame.forward().z() / frame.forward().y(), 10.0 / 79, 1e-12);
  EXPECT_LT(frame.forward().z(), 0);
  EXPECT_NEAR(frame.left.x(), 1, 1e-15);
  // Natural head position does not depend on them.
  expect_axes(clinical_frame(marks, natural_position), Eigen::Matrix3d::Identity(), 1e-15);
}

TEST(ClinicalFrame, NaturalHeadPositionHasTheGivenVertical) {
  // The head is held 10 degrees chin up relative to the case's axes: v_N = R v_C lifts the face.
  const Eigen::Quaterniond R_NC(Eigen::AngleAxisd(-10 * degree, Vector3d::UnitX()));
  HeadReference reference = natural_position;
  reference.R_NC = R_NC;
  const ClinicalFrame frame = clinical_frame(test::upright_marks(), reference);
  EXPECT_GT((R_NC * Vector3d(0, -1, 0)).z(), 0.17);  // forward of the case points upward
  EXPECT_NEAR(frame.up.dot(R_NC.conjugate() * Vector3d::UnitZ()), 1, 1e-15);
  EXPECT_NEAR(frame.up.y(), -std::sin(10 * degree), 1e-12);
  EXPECT_NEAR(frame.left.x(), 1, 1e-15);
}

TEST(ClinicalFrame, DirectionsHaveOppositesAndComponents) {
  const ClinicalFrame frame = clinical_frame(test::upright_marks());
  EXPECT_EQ(frame.forward(), -frame.back);
  EXPECT_EQ(frame.right(), -frame.left);
  EXPECT_EQ(frame.down(), -frame.up);
  const Vector3d v(1, 2, 3);
  EXPECT_NEAR((frame.vector(frame.components(v)) - v).norm(), 0, 1e-14);
}

TEST(ClinicalFrame, OtherLandmarksStandInAndAreNamed) {
  Landmarks marks = test::upright_marks();
  marks.points.erase("basion");
  marks.points.erase("right_orbitale");
  const ClinicalFrame frame = clinical_frame(marks);
  expect_axes(frame, Eigen::Matrix3d::Identity(), 1e-14);
  ASSERT_EQ(frame.notes.size(), 1u);
  EXPECT_EQ(frame.notes[0], "midsagittal plane: sella for basion");
}

TEST(ClinicalFrame, MissingLandmarksAreNamed) {
  Landmarks marks = test::upright_marks();
  marks.points.erase("nasion");
  EXPECT_NE(frame_refusal(marks).find("nasion"), std::string::npos);  // there is no glabella
  marks = test::upright_marks();
  marks.points.erase("left_orbitale");
  marks.points.erase("right_orbitale");
  EXPECT_NE(frame_refusal(marks).find("left_orbitale"), std::string::npos);
  marks = test::upright_marks();
  marks.points.erase("left_porion");
  EXPECT_NE(frame_refusal(marks).find("left_porion"), std::string::npos);
}

TEST(ClinicalFrame, NaturalHeadPositionNeedsNoLandmark) {
  const ClinicalFrame frame = clinical_frame({}, natural_position);
  expect_axes(frame, Eigen::Matrix3d::Identity(), 1e-15);
  ASSERT_EQ(frame.notes.size(), 1u);
  EXPECT_NE(frame.notes[0].find("nasion"), std::string::npos);
}

TEST(ClinicalFrame, ImpossibleLandmarksAreRefused) {
  Landmarks marks = test::upright_marks();
  std::swap(marks.points["left_porion"], marks.points["right_porion"]);
  EXPECT_NE(frame_refusal(marks).find("left_porion lies to the right"), std::string::npos);
  marks = test::upright_marks();
  marks.points["basion"] = 0.5 * marks.points["nasion"];  // the midpoint of the porions is 0
  EXPECT_NE(frame_refusal(marks).find("in line"), std::string::npos);
  marks = test::upright_marks();
  std::swap(marks.points["left_porion"], marks.points["left_orbitale"]);
  std::swap(marks.points["right_porion"], marks.points["right_orbitale"]);
  EXPECT_NE(frame_refusal(marks).find("exchanged"), std::string::npos);
  HeadReference lying = natural_position;
  lying.R_NC = Eigen::AngleAxisd(90 * degree, Vector3d::UnitY());
  EXPECT_NE(frame_refusal(test::upright_marks(), lying).find("vertical"), std::string::npos);
}
