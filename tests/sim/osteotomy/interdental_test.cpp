#include "sim/osteotomy/interdental.h"

#include "sim/osteotomy/danger_zones.h"
#include "tests/sim/osteotomy/osteotomies.h"
#include "tests/sim/plan/marks.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle::test {
namespace {

/// Built-in heads of seeds and variants.
std::vector<Case> heads() {
  return {builtin(), builtin_patient({.seed = 3}), builtin_patient({.seed = 5}),
          builtin_patient({.variant = HeadChoice::Variant::class_iii})};
}

/// Two teeth as boxes in a bar of bone, with their roots this far apart.
Case two_teeth(double apart_mm) {
  Case patient;
  patient.landmarks = upright_marks();
  Part bone;
  bone.name = "mandible";
  bone.role = Role::mandible;
  bone.body = mandible_body;
  bone.mesh = box({0, -90, -80}, {60, -80, -50});
  Part teeth;
  teeth.name = "lower_teeth";
  teeth.role = Role::lower_teeth;
  teeth.body = mandible_body;
  const auto tooth = [](double x) {  // in slices, so that its corners are close together
    TriMesh slices = box({x - 3, -88, -65}, {x + 3, -82, -64});
    for (double z = -64; z < -42; ++z)
      slices = joined(slices, box({x - 3, -88, z}, {x + 3, -82, z + 1}));
    return slices;
  };
  const TriMesh one = tooth(20), two = tooth(26 + apart_mm);
  teeth.mesh = joined(one, two);
  const int count = static_cast<int>(one.triangles.size());
  teeth.teeth = {{33, 0, count}, {34, count, count}};
  patient.parts = {bone, teeth};
  return patient;
}

}  // namespace

TEST(Interdental, ThePlaneLiesInTheMiddleOfTheRoom) {
  const Case patient = two_teeth(3);
  const SurgicalAnatomy jaw(patient, patient.parts[0]);
  const auto plane = find_interdental(jaw, 33, 34);
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->root_mm, 1.5, 1e-6);
  EXPECT_NEAR(plane->crown_mm, 1.5, 1e-6);
  EXPECT_NEAR(std::abs(plane->normal.x()), 1, 1e-9);
  EXPECT_NEAR(std::abs(plane->point.x()), 24.5, 1e-6);
  EXPECT_EQ(
      room_text(*plane, 0.6),
      "teeth 33 and 34: more than 3 mm from the crest, their roots leave 3.0 mm for the cut; 1 "
      "mm of bone on each root and the saw require 2.6 mm");
  EXPECT_FALSE(find_interdental(jaw, 34, 35));
}

TEST(Interdental, CutsAreStoppedWhereTheRoomIsTooSmall) {
  for (const auto& [apart, level] :
       {std::pair{3.0, DangerLevel::clear}, {1.9, DangerLevel::warn}, {0.8, DangerLevel::stop}}) {
    const Case patient = two_teeth(apart);
    const Part& bone = patient.parts[0];
    const SurgicalAnatomy jaw(patient, bone);
    const auto plane = find_interdental(jaw, 33, 34);
    ASSERT_TRUE(plane);
    const Cut cut{"gap", jaw.above(plane->point, plane->normal, interdental_wall), {}, 0.2};
    const auto pieces = cut_bone(bone.mesh, {&cut, 1}).pieces;
    const auto findings = check_danger_zones(danger_zones(patient, bone, true), pieces);
    ASSERT_EQ(findings.size(), 2u);
    for (const DangerFinding& finding : findings) {
      EXPECT_TRUE(finding.interdental);
      EXPECT_NEAR(finding.distance_mm, apart / 2 - 0.1, 1e-6);
      EXPECT_EQ(finding.level, level) << apart;
    }
    // The same faces of another cut are nearer than any root should be.
    const Cut other{"saw", jaw.above(plane->point, plane->normal, 0), {}, 0.2};
    EXPECT_EQ(check_danger_zones(danger_zones(patient, bone, true),
                                 cut_bone(bone.mesh, {&other, 1}).pieces)[0]
                  .level,
              DangerLevel::stop);
  }
}

TEST(Interdental, OsteotomiesBetweenTheTeethOfBuiltInHeads) {
  const std::vector<std::pair<CutStep, std::vector<std::string>>> osteotomies = {
      {named("body_osteotomy", {}, 0), {"proximal_left", "proximal_right", "distal"}},
      {named("le_fort_1", {{"pieces", 2}}, 0), {"", "maxilla_left", "maxilla_right"}},
      {named("le_fort_1", {{"pieces", 3}}, 0),
       {"", "maxilla_front", "maxilla_left", "maxilla_right"}},
      {named("le_fort_1", {{"pieces", 3}, {"front_teeth", 3}}, 0),
       {"", "maxilla_front", "maxilla_left", "maxilla_right"}}};
  for (const Case& head : heads())
    for (const auto& [step, segments] : osteotomies) {
      SCOPED_TRACE(head.name + " " + step.osteotomy);
      const Operated done = operate(head, step);
      expect_parted(done, segments);
      EXPECT_FALSE(done.placed.rooms.empty());
      const Part& bone = part_named(head, done.placed.part);
      int interdental = 0;
      for (const auto& finding :
           check_danger_zones(danger_zones(head, bone, true), done.result.pieces)) {
        EXPECT_NE(finding.level, DangerLevel::stop) << danger_text(finding);
        if (finding.interdental && finding.distance_mm < 1.5) ++interdental;
      }
      EXPECT_GE(interdental, 2);
    }
}

}  // namespace condyle::test
