#include "sim/operation/segment_overlaps.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/operation/box_operation.h"

namespace condyle::test {
namespace {

Operated operated_with(const ClinicalMove& chin) {
  const Case patient = operable_patient();
  return apply_plan(patient, plan_of(patient, {chin_step(), MoveStep{"chin", chin}}));
}

Pose raised(double mm) {
  Pose X;
  X.t.z() = mm;
  return X;
}

}  // namespace

TEST(SegmentOverlaps, OfPiecesOfOneBoneAreTrimmedAndHaveTheExactVolume) {
  EXPECT_TRUE(segment_overlaps(operated_with({})).empty());
  // Half a millimetre of kerf, then 2 mm into the jaw of 100 x 92 mm.
  const Operated operated = operated_with({.up_mm = 2.5});
  const auto overlaps = segment_overlaps(operated);
  ASSERT_EQ(overlaps.size(), 1u);
  EXPECT_EQ(overlaps[0].kind, SegmentOverlap::Kind::trimmed);
  EXPECT_NEAR(overlaps[0].depth_mm, 2, 0.02);
  EXPECT_NEAR(overlaps[0].volume_mm3, 2 * 100 * 92, 20);
  // Within the overlap: between the jaw's lower side and the chin's upper one.
  EXPECT_GT(overlaps[0].at.z(), -69.76);
  EXPECT_LT(overlaps[0].at.z(), -67.74);
  // Nothing is to be refused.
  const auto pose = [&](double f) { return raised(2.5 * f); };
  EXPECT_EQ(free_fraction(operated, "chin", pose), 1);
}

TEST(SegmentOverlaps, WithOtherBonesAreCollisionsOfWhichAPartIsFree) {
  // The chin rises through the jaw to the skull, whose lower side lies at z = -30: its own upper
  // side, at -70.25, is 40.25 mm below.
  const Operated operated = operated_with({.up_mm = 45});
  const auto overlaps = segment_overlaps(operated, "chin");
  const auto hit = std::find_if(overlaps.begin(), overlaps.end(), [](const auto& overlap) {
    return overlap.kind == SegmentOverlap::Kind::collision && (overlap.a == "skull");
  });
  ASSERT_NE(hit, overlaps.end());
  EXPECT_NEAR(hit->depth_mm, 45 - 40.25, 0.02);
  const auto pose = [&](double f) { return raised(45 * f); };
  const double fraction = free_fraction(operated, "chin", pose);
  EXPECT_GT(fraction, 0);
  // The first obstacle is the lowest tooth or the skull.
  EXPECT_LT(45 * fraction, 40.4);
  EXPECT_TRUE(segment_overlaps(operated, "chin").size() >= 2);
}

TEST(SegmentOverlaps, TeethCountWithTheBoneThatCarriesThem) {
  // The upper teeth reach to z = -20 in the skull, which is cut at -10.
  const Case patient = operable_patient();
  const Operated operated = apply_plan(
      patient, plan_of(patient, {maxilla_step(), MoveStep{"maxilla", ClinicalMove{.up_mm = 14}}}));
  int with_teeth = 0;
  for (const SegmentOverlap& overlap : segment_overlaps(operated, "maxilla"))
    if (overlap.a == "upper_teeth" || overlap.b == "upper_teeth") {
      ++with_teeth;
      EXPECT_EQ(overlap.kind, SegmentOverlap::Kind::trimmed);
    }
  EXPECT_EQ(with_teeth, 1);
}

}  // namespace condyle::test
