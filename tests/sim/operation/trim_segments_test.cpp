#include "sim/operation/trim_segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/operation/cut_text.h"
#include "sim/operation/segment_overlaps.h"
#include "tests/sim/operation/box_operation.h"
#include "tests/support/builtin.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

TrimStep trim(const std::string& segment, std::vector<std::string> of) {
  return {.segment = segment, .of = std::move(of)};
}

/// Overlaps of pieces of one bone, teeth left out.
double bone_overlap_mm3(const Operated& operated) {
  double sum = 0;
  for (const SegmentOverlap& overlap : segment_overlaps(operated))
    if (overlap.kind == SegmentOverlap::Kind::trimmed && operated.origin.contains(overlap.a) &&
        operated.origin.contains(overlap.b))
      sum += overlap.volume_mm3;
  return sum;
}

/// The bones that cuts made are closed, and pieces, kerfs and trimmed bone are the whole.
void expect_whole(const Operated& operated, double whole_mm3) {
  double sum = 0;
  for (const BoneSummary& bone : operated_bones(operated)) {
    EXPECT_TRUE(bone.closed) << bone.name;
    sum += bone.volume_mm3 + bone.trimmed_mm3;
  }
  for (const CutReport& cut : operated.cuts) sum += cut.kerf_volume_mm3;
  EXPECT_NEAR(sum / whole_mm3, 1, 1e-9);
  for (const TrimReport& report : operated.trims) EXPECT_LT(report.volume_error_percent(), 1e-7);
  for (const auto& [part, origin] : operated.origin) {
    const TriMesh& mesh = part_named(operated.patient, part)->mesh;
    EXPECT_EQ(origin.triangle.size(), mesh.triangles.size()) << part;
    EXPECT_EQ(origin.made_by.size(), mesh.triangles.size()) << part;
  }
}

double volume_of_bone(const Case& patient, const char* part) {
  return signed_volume(part_named(patient, part)->mesh);
}

}  // namespace

TEST(TrimSegments, RemovesTheExactOverlapOfEitherSegment) {
  const Case patient = operable_patient();
  for (const bool of_chin : {true, false}) {
    // Half a millimetre of kerf, then 2 mm into the jaw of 100 x 92 mm.
    const TrimStep step = of_chin ? trim("chin", {"mandible"}) : trim("mandible", {"chin"});
    const Operated operated = apply_plan(
        patient,
        plan_of(patient, {chin_step(), MoveStep{"chin", ClinicalMove{.up_mm = 2.5}}, step}));
    ASSERT_TRUE(operated.problems.empty()) << operated.problems[0];
    ASSERT_EQ(operated.trims.size(), 1u);
    EXPECT_NEAR(operated.trims[0].removed_mm3(), 2 * 100 * 92, 1e-6);
    EXPECT_EQ(bone_overlap_mm3(operated), 0);
    expect_whole(operated, volume_of_bone(patient, "mandible"));
    const SurfaceOrigin& origin = operated.origin.at(operated.trims[0].part);
    EXPECT_EQ(std::count(origin.made_by.begin(), origin.made_by.end(), 3) > 0, true);
  }
}

TEST(TrimSegments, FollowsWhatIsChangedBeforeIt) {
  const Case patient = operable_patient();
  const auto with = [&](const ClinicalMove& move) {
    return apply_plan(patient, plan_of(patient, {chin_step(), trim("chin", {"mandible"}),
                                                 MoveStep{"chin", move}}));
  };
  // A move after the trim counts for it, too; turned, the overlap is a wedge.
  EXPECT_NEAR(with({.up_mm = 3.5}).trims[0].removed_mm3(), 3 * 100 * 92, 1e-6);
  const Operated turned = with({.left_mm = 3, .up_mm = 1, .roll_deg = 2, .pitch_deg = 4});
  EXPECT_GT(turned.trims[0].removed_mm3(), 1000);
  EXPECT_EQ(bone_overlap_mm3(turned), 0);
  expect_whole(turned, volume_of_bone(patient, "mandible"));
  const Operated apart = with({.up_mm = -2});
  EXPECT_EQ(apart.trims[0].removed_mm3(), 0);
  EXPECT_EQ(apart.trims[0].notes.size(), 1u);
  EXPECT_TRUE(apart.problems.empty());
  // The same plan replays to the same bits.
  const Operated again = with({.left_mm = 3, .up_mm = 1, .roll_deg = 2, .pitch_deg = 4});
  EXPECT_EQ(part_named(again.patient, "chin")->mesh.vertices,
            part_named(turned.patient, "chin")->mesh.vertices);
}

TEST(TrimSegments, ATrimThatWouldTakeARootIsAProblem) {
  // The upper teeth reach to z = -20 in the skull, which is cut at -10.
  const Case patient = operable_patient();
  const Operated operated = apply_plan(
      patient, plan_of(patient, {maxilla_step(), MoveStep{"maxilla", ClinicalMove{.up_mm = 14}},
                                 trim("maxilla", {"cranium"})}));
  ASSERT_EQ(operated.problems.size(), 1u);
  EXPECT_NE(operated.problems[0].find("step 3 (trim maxilla): tooth "), std::string::npos)
      << operated.problems[0];
  EXPECT_EQ(operated.trims[0].removed_mm3(), 0);
  // The skull gives way instead.
  const Operated other = apply_plan(
      patient, plan_of(patient, {maxilla_step(), MoveStep{"maxilla", ClinicalMove{.up_mm = 14}},
                                 trim("cranium", {"maxilla"})}));
  EXPECT_TRUE(other.problems.empty());
  EXPECT_EQ(bone_overlap_mm3(other), 0);
  expect_whole(other, volume_of_bone(patient, "skull"));
}

TEST(TrimSegments, OfASetbackAfterASagittalSplit) {
  const Case patient = builtin_patient({.variant = HeadChoice::Variant::class_iii, .seed = 0});
  const std::vector<PlanAction> setback = {
      CutStep{.osteotomy = "sagittal_split",
              .pieces = {"proximal_left", "proximal_right", "distal"}},
      MoveStep{"distal", ClinicalMove{.forward_mm = -5, .yaw_deg = 1}}};
  const Operated before = apply_plan(patient, plan_of(patient, setback));
  const double overlap = bone_overlap_mm3(before);
  ASSERT_GT(overlap, 1000);
  EXPECT_EQ(trimming_segments(before, "distal").size(), 2u);
  auto steps = setback;
  steps.push_back(trim("distal", {"proximal_left", "proximal_right"}));
  const Operated after = apply_plan(patient, plan_of(patient, steps));
  ASSERT_TRUE(after.problems.empty()) << after.problems[0];
  EXPECT_EQ(bone_overlap_mm3(after), 0);
  expect_whole(after, volume_of_bone(patient, "mandible"));
  const TrimReport& report = after.trims[0];
  EXPECT_EQ(report.pieces, 1);
  // All that overlapped, and not much more.
  EXPECT_GT(report.removed_mm3(), 0.99 * overlap);
  EXPECT_LT(report.removed_mm3(), 2 * overlap);
  EXPECT_LT(report.removed_mm3(), 0.06 * report.before_mm3);
}

TEST(TrimSegments, OfARealJaw) {
  const auto patient = case_badin();
  if (!patient) GTEST_SKIP() << "no case-badin";
  Plan plan = plan_of(*patient, {CutStep{.osteotomy = "sagittal_split",
                                         .kerf_mm = 0.5,
                                         .pieces = {"proximal_left", "proximal_right", "distal"}}});
  plan.reference.horizontal = Horizontal::natural_head_position;
  plan = with_step(std::move(plan), MoveStep{"distal", ClinicalMove{.forward_mm = -4}});
  const Operated before = apply_plan(*patient, plan);
  const double overlap = bone_overlap_mm3(before);
  ASSERT_GT(overlap, 100);
  plan = with_step(std::move(plan), trim("distal", trimming_segments(before, "distal")));
  const Operated after = apply_plan(*patient, plan);
  ASSERT_TRUE(after.problems.empty()) << after.problems[0];
  // The jaw's surface crosses itself: what is left is below a hundredth.
  EXPECT_LT(bone_overlap_mm3(after), 0.01 * overlap);
  EXPECT_LT(after.trims[0].volume_error_percent(), 1e-7);
  double sum = after.trims[0].removed_mm3();
  for (const BoneSummary& bone : operated_bones(after)) {
    EXPECT_TRUE(bone.closed) << bone.name;
    sum += bone.volume_mm3;
  }
  for (const CutReport& cut : after.cuts) sum += cut.kerf_volume_mm3;
  EXPECT_NEAR(sum / after.cuts[0].volume_mm3, 1, 1e-9);
}

}  // namespace condyle::test
