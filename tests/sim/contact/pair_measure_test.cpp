#include "sim/contact/pair_measure.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "sim/contact/contact.h"
#include "tests/support/boxes.h"
#include "tests/support/real_cases.h"
#include "tests/support/shapes.h"

namespace condyle::test {
namespace {

TEST(PairMeasure, CapOfABallInABoxAtAnyPose) {
  // The mandible is a ball that sinks into the maxilla, a box; the measure must not care how its
  // mesh stands at rest.
  std::mt19937_64 random(5);
  for (int i = 0; i < 5; ++i) {
    const Pose X_rest = any_pose(random, 40);
    Case patient = box_patient();
    patient.parts[1].mesh = moved(sphere(5, 12, {15, -65, -50}), X_rest);
    BodyPoses at;
    at = X_rest.inverse();  // puts the ball 2 mm into the box
    const ContactModel model(patient);
    const PairMeasures measures(patient);
    const auto set = model.find(at, nullptr);
    const auto measure = measures.measure(set.pairs.at(0), at);
    const double area = 2 * std::numbers::pi * 12 * 2.1;
    const double volume = std::numbers::pi * 4 * (3 * 12 - 2) / 3;
    EXPECT_NEAR(measure.area_mm2, area, 0.02 * area);
    ASSERT_TRUE(measure.volume_known);
    EXPECT_NEAR(measure.volume_mm3, volume, 0.01 * volume);
    EXPECT_EQ(measure.patches, 1);
    EXPECT_EQ(measure.side, "left");
    EXPECT_LT((measure.place - Eigen::Vector3d(15, -65, -38)).norm(), 0.2);
    EXPECT_LT((measure.normal - Eigen::Vector3d(0, 0, -1)).norm(), 0.02);
  }
}

TEST(NearTriangles, KeepsAllThatAreInReachAndFewOthers) {
  std::mt19937_64 random(6);
  const TriMesh ball = sphere(4, 10), bumpy = sphere(5, 12, {0, 0, 0}, 0.1);
  const SignedSurface other(ball);
  const NearTriangles triangles(bumpy);
  int kept = 0, all = 0;
  for (int i = 0; i < 10; ++i) {
    const Pose X_O = any_pose(random, 20);
    Pose X = any_pose(random, 5);
    X.t += X_O.t + Eigen::Vector3d(0, 0, 21);
    const TriMesh found = triangles.near(X, other, X_O, 0.1);
    int in_reach = 0, found_in_reach = 0;
    const auto reaches = [&](const TriMesh& mesh, const Eigen::Vector3i& t) {
      const Eigen::Vector3d middle =
          (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
      return other.distance(X_O.inverse() * (X * middle)) < 0.1;
    };
    for (const auto& t : bumpy.triangles) in_reach += reaches(bumpy, t);
    for (const auto& t : found.triangles) found_in_reach += reaches(found, t);
    EXPECT_EQ(found_in_reach, in_reach);
    kept += static_cast<int>(found.triangles.size());
    all += static_cast<int>(bumpy.triangles.size());
  }
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, all / 3);
}

TEST(AnatomicalRegions, NamesOfTheJawsRegions) {
  Case patient = box_patient();
  patient.landmarks.points["right_coronoid_tip"] = {-46, -40, -10};
  const AnatomicalRegions places(patient);
  EXPECT_EQ(places.midline_mm(), 0);
  EXPECT_EQ(places.name(1, {47, -6, -10}), "left condyle");
  EXPECT_EQ(places.name(0, {47, -6, -6}), "left joint fossa");
  EXPECT_EQ(places.name(1, {-45, -40, -14}), "right coronoid process");
  EXPECT_EQ(places.name(1, {45, -25, -60}), "left ramus");
  EXPECT_EQ(places.name(1, {-30, -60, -70}), "right body of the mandible");
  EXPECT_EQ(places.name(1, {2, -90, -70}), "chin");
  EXPECT_EQ(places.name(0, {60, -50, -10}), "left zygomatic bone or arch");
  EXPECT_EQ(places.name(0, {-25, -35, -40}), "right half of the upper jaw");  // the back teeth
  EXPECT_EQ(places.name(0, {-25, -35, -5}), "right half of the skull base");
  EXPECT_EQ(join_regions("tooth 26", "tooth 36"), "teeth 26 and 36");
  EXPECT_EQ(join_regions("tooth 26", "chin"), "tooth 26 and chin");
}

TEST(AnatomicalRegions, CoronoidTipIsNamedOrFoundInFrontOfTheNotch) {
  Case patient = box_patient();
  // A ramus whose upper border falls from the condyle to a notch and rises again.
  const auto ramus = [](double side) {
    return joined(joined(box({44, -10, -60}, {52, 0, -8}), box({44, -23, -60}, {52, -13, -25})),
                  box({44, -40, -60}, {52, -25, -5 - side}));
  };
  TriMesh right = ramus(4);
  for (auto& v : right.vertices) v.x() = -v.x();
  patient.parts[1].mesh = joined(ramus(0), right);
  const auto left_tip = coronoid_tip(patient, "left"), right_tip = coronoid_tip(patient, "right");
  ASSERT_TRUE(left_tip && right_tip);
  EXPECT_TRUE(left_tip->estimated);
  EXPECT_EQ(left_tip->point.z(), -5);
  EXPECT_EQ(right_tip->point.z(), -9);
  EXPECT_LT(right_tip->point.x(), 0);
  patient.landmarks.points["left_coronoid_tip"] = {1, 2, 3};
  EXPECT_FALSE(coronoid_tip(patient, "left")->estimated);
  patient.parts[1].mesh = box({44, -40, -60}, {52, 0, -8});
  EXPECT_FALSE(coronoid_tip(patient, "right"));
}

TEST(PairMeasure, RealCrownsThatOverlapAtRest) {
  auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const ContactModel model(*patient);
  const PairMeasures measures(*patient);
  int checked = 0;
  for (const auto& pair : model.at_rest().pairs) {
    const auto measure = measures.measure(pair, Pose{});
    EXPECT_TRUE(measure.volume_known);
    EXPECT_GT(measure.area_mm2, 5);
    EXPECT_GT(measure.volume_mm3, 1);
    EXPECT_LT(measure.volume_error_mm3, 0.05 * measure.volume_mm3);
    EXPECT_EQ(measure.side, "both");
    EXPECT_FALSE(measure.region_a.empty());
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

}  // namespace
}  // namespace condyle::test
