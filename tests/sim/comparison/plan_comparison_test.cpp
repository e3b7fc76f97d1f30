// Differences of two plans, and of a plan and an operated patient, that are known.
#include "sim/comparison/plan_comparison.h"

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/support/builtin.h"

namespace condyle::test {
namespace {

Plan chin_plan(double forward_mm, double pitch_deg) {
  Plan plan;
  plan.name = "chin";
  plan.geometry = geometry_of(builtin());
  CutStep cut;
  cut.osteotomy = "genioplasty";
  cut.kerf_mm = 0.5;
  cut.pieces = {"chin"};
  plan = with_step(plan, cut);
  ClinicalMove move;
  move.about = "centroid";
  move.forward_mm = forward_mm;
  move.pitch_deg = pitch_deg;
  return with_step(plan, MoveStep{"chin", move});
}

const SegmentDifference& chin_of(const PlanComparison& comparison) {
  for (const auto& segment : comparison.segments)
    if (segment.body == "chin") return segment;
  throw std::logic_error("no chin");
}

}  // namespace

TEST(ComparePlans, DifferencesOfMovesAreFoundWithTheirSigns) {
  const ClinicalFrame frame = clinical_frame(builtin().landmarks);
  const Operated first = apply_plan(builtin(), chin_plan(4, 0)),
                 second = apply_plan(builtin(), chin_plan(7, 5));
  const PlanComparison same = compare_plans(first, first, frame);
  EXPECT_LT(chin_of(same).distance_mm(), 1e-9);
  EXPECT_TRUE(chin_of(same).accepted());
  const SegmentDifference chin = chin_of(compare_plans(first, second, frame));
  EXPECT_NEAR(chin.forward_mm, 3, 0.5);  // the centroid of its vertices is not that of its volume
  EXPECT_NEAR(chin.pitch_deg, 5, 1e-6);
  EXPECT_NEAR(chin.angle_deg, 5, 1e-6);
  EXPECT_FALSE(chin.accepted());
  const SegmentDifference back = chin_of(compare_plans(second, first, frame));
  EXPECT_NEAR(back.forward_mm, -3, 0.5);
}

TEST(ComparePlans, AnOperatedCaseIsMeasuredInAnyPosition) {
  const ClinicalFrame frame = clinical_frame(builtin().landmarks);
  const Operated planned = apply_plan(builtin(), chin_plan(4, 0)),
                 done = apply_plan(builtin(), chin_plan(6, 0));
  Case achieved = operated_case(done);
  Pose X;
  X.R = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 1, 3).normalized());
  X.t = {200, -50, 900};
  for (Part& part : achieved.parts)
    for (auto& p : part.mesh.vertices) p = X * p;
  for (auto& [name, p] : achieved.landmarks.points) p = X * p;
  const PlanComparison comparison = compare_with_case(planned, achieved, frame);
  const SegmentDifference chin = chin_of(comparison);
  EXPECT_NEAR(chin.forward_mm, 2, 0.05);
  EXPECT_NEAR(chin.left_mm, 0, 0.05);
  EXPECT_LT(chin.angle_deg, 0.1);
  ASSERT_FALSE(comparison.landmarks.empty());
  for (const auto& row : comparison.landmarks)
    EXPECT_NEAR(row.forward_mm, row.landmark == "pogonion" || row.landmark == "menton" ? 2 : 0,
                0.05)
        << row.label;
}

TEST(ComparePlans, ACaseWithoutBoneIsRefused) {
  const ClinicalFrame frame = clinical_frame(builtin().landmarks);
  Case empty = builtin();
  std::erase_if(empty.parts, [](const Part& part) { return part.role != Role::face; });
  EXPECT_THROW(compare_with_case(apply_plan(builtin(), chin_plan(4, 0)), empty, frame), InputError);
}

}  // namespace condyle::test
