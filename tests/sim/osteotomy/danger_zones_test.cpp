#include "sim/osteotomy/danger_zones.h"

#include <gtest/gtest.h>

#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

/// A bar of bone along x with a canal, a foramen and two teeth standing on it.
Case bar_with_zones() {
  Case patient;
  Part bone;
  bone.name = "mandible";
  bone.role = Role::mandible;
  bone.body = mandible_body;
  bone.mesh = test::box({0, 0, 0}, {40, 10, 20});
  Part teeth;
  teeth.name = "lower_teeth";
  teeth.role = Role::lower_teeth;
  teeth.body = mandible_body;
  const TriMesh one = test::sphere(2, 2, {12, 5, 18}), two = test::sphere(2, 2, {30, 5, 18});
  teeth.mesh = test::joined(one, two);
  const int count = static_cast<int>(one.triangles.size());
  teeth.teeth = {{36, 0, count}, {46, count, count}};
  patient.parts = {bone, teeth};
  patient.canals = {{"left_mandibular_canal", mandible_body, 3, {{0, 5, 5}, {40, 5, 5}}}};
  patient.landmarks.points["left_mental_foramen"] = {24, 0, 8};
  return patient;
}

std::vector<DangerFinding> findings_of(const Cut& cut) {
  const Case patient = bar_with_zones();
  return check_danger_zones(danger_zones(patient, patient.parts[0]),
                            cut_bone(patient.parts[0].mesh, {&cut, 1}).pieces);
}

const DangerFinding* named(const std::vector<DangerFinding>& findings, const std::string& zone) {
  for (const auto& finding : findings)
    if (finding.zone == zone) return &finding;
  return nullptr;
}

TEST(DangerZones, StateTheLeastDistanceOfACutFromEach) {
  const auto findings =
      findings_of({"across", Region::above({Eigen::Vector3d::UnitX(), 20}), {}, 1});
  // The faces of the kerf are at x = 19.5 and 20.5; tooth 36 ends at x = 14, 46 begins at 28.
  const auto* tooth = named(findings, "tooth 36");
  ASSERT_TRUE(tooth);
  EXPECT_NEAR(tooth->distance_mm, 5.5, 0.05);
  EXPECT_EQ(tooth->level, DangerLevel::clear);
  ASSERT_TRUE(named(findings, "tooth 46"));
  EXPECT_NEAR(named(findings, "tooth 46")->distance_mm, 7.5, 0.05);
  const auto* foramen = named(findings, "left mental foramen");
  ASSERT_TRUE(foramen);
  EXPECT_NEAR(foramen->distance_mm, 3.5, 1e-9);
  EXPECT_EQ(foramen->level, DangerLevel::warn);
  EXPECT_EQ(danger_text(*foramen), "left mental foramen: 3.5 mm from the cut, less than 5 mm");
  const auto* canal = named(findings, "left mandibular canal");
  ASSERT_TRUE(canal);
  EXPECT_NEAR(canal->distance_mm, -1.5, 1e-9) << "the cut divides it";
  EXPECT_EQ(canal->level, DangerLevel::stop);
  EXPECT_EQ(danger_text(*canal), "left mandibular canal: the cut enters it by 1.5 mm");
  EXPECT_EQ(findings.front().zone, "left mandibular canal") << "nearest first";
}

TEST(DangerZones, ACutAboveTheCanalIsWarnedOfByItsMargin) {
  const auto findings = findings_of({"along", Region::above({Eigen::Vector3d::UnitZ(), 8}), {}, 0});
  const auto* canal = named(findings, "left mandibular canal");
  ASSERT_TRUE(canal);
  EXPECT_NEAR(canal->distance_mm, 1.5, 1e-9);
  EXPECT_EQ(canal->level, DangerLevel::warn);
  EXPECT_NEAR(canal->at.z(), 8, 1e-9);
  EXPECT_EQ(named(findings, "left mental foramen")->level, DangerLevel::stop);
}

TEST(DangerZones, ACutThatMissesTheBoneEndangersNothing) {
  EXPECT_TRUE(findings_of({"off", Region::above({Eigen::Vector3d::UnitX(), 50}), {}, 0}).empty());
}

TEST(DangerZones, AreThoseOfTheCutBoneAlone) {
  Case patient = bar_with_zones();
  Part upper = patient.parts[1];  // an upper tooth beside the cut
  upper.name = "upper_teeth";
  upper.role = Role::upper_teeth;
  upper.body = cranium_body;
  upper.teeth = {{16, 0, upper.teeth[0].triangle_count}};
  patient.parts.push_back(upper);
  patient.landmarks.points["left_infraorbital_foramen"] = {20, 0, 8};
  const Cut cut{"across", Region::above({Eigen::Vector3d::UnitX(), 20}), {}, 1};
  const auto pieces = cut_bone(patient.parts[0].mesh, {&cut, 1}).pieces;
  const auto findings = check_danger_zones(danger_zones(patient, patient.parts[0]), pieces);
  EXPECT_EQ(findings.size(), 4u);
  EXPECT_FALSE(named(findings, "tooth 16"));
  EXPECT_FALSE(named(findings, "left infraorbital foramen"));
  EXPECT_TRUE(named(findings, "tooth 36"));
  // After a cut, to the piece: of a foramen the nearest.
  Part piece = patient.parts[0];
  piece.name = "far";
  piece.role = Role::segment;
  piece.body =
      patient.bodies.add({.name = "far", .parent = mandible_body, .driver = BodyDriver::plan});
  piece.mesh = test::box({0, 0, 21}, {40, 10, 30});
  patient.parts.push_back(piece);
  EXPECT_TRUE(danger_zones(patient, piece).empty());
  EXPECT_EQ(danger_zones(patient, patient.parts[0]).size(), 4u);
}

TEST(DangerZones, OfTheUsersOwnCountWithTheirMargins) {
  const Cut cut{"across", Region::above({Eigen::Vector3d::UnitX(), 20}), {}, 1};
  const auto pieces = cut_bone(bar_with_zones().parts[0].mesh, {&cut, 1}).pieces;
  const auto finding = [&](const PlanZone& zone) {
    return check_danger_zones({own_zone(zone)}, pieces).at(0);
  };
  // A line of radius 1.5 at x = 26; the face is at 20.5.
  const PlanZone line{.name = "artery", .radius_mm = 1.5, .points = {{26, 5, 0}, {26, 5, 20}}};
  EXPECT_NEAR(finding(line).distance_mm, 4, 1e-9);
  EXPECT_EQ(finding(line).level, DangerLevel::warn);
  PlanZone strict = line;
  strict.stop_mm = 4.5;
  EXPECT_EQ(finding(strict).level, DangerLevel::stop);
  EXPECT_EQ(danger_text(finding(strict)),
            "artery: 4.0 mm from the cut; at least 4.5 mm are needed");
  // A large box around the cut: its surface is far away, and the cut lies inside.
  const TriMesh around = test::box({-20, -20, -20}, {60, 30, 40});
  const PlanZone tumour{.name = "tumour", .points = around.vertices, .triangles = around.triangles};
  EXPECT_LT(finding(tumour).distance_mm, -19);
  EXPECT_EQ(finding(tumour).level, DangerLevel::stop);
}

}  // namespace
}  // namespace condyle
