// Where tissue comes to lie does not depend on the steps that took it there, on real anatomy.
#include "sim/tissue/ten_steps.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "tests/support/builtin.h"
#include "tests/support/scan_case.h"

namespace condyle::test {
namespace {

void expect_same_tissue(Case patient) {
  part_lips(patient);
  const auto model = build_tissue(patient);
  for (double opened_deg : {2.0, 5.0, 14.0, 22.0, 25.0}) {
    const TenSteps steps = ten_steps(*model, opened_deg * std::numbers::pi / 180);
    std::printf("opened by %.0f degrees: ten steps end %.4f mm from one (as frames end: %.2f mm)\n",
                opened_deg, steps.difference_mm, steps.of_frames_mm);
    EXPECT_TRUE(steps.settled) << opened_deg;
    EXPECT_GT(steps.moved_mm, 0.8) << opened_deg;
    EXPECT_LT(steps.difference_mm, 0.01) << opened_deg;
  }
}

TEST(TenSteps, EqualOneWholeStepInTheBuiltInPatient) { expect_same_tissue(builtin()); }

TEST(TenSteps, EqualOneWholeStepInARealPatient) {
  const auto patient = case_badin_with_face();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_same_tissue(*patient);
}

// A frame of a few iterations stops far from where the tissue belongs.
TEST(TenSteps, SettlingEndsAtOnePlaceFromAnyStart) {
  const Case& patient = builtin();
  const auto model = build_tissue(patient);
  Pose X_CM;
  X_CM.t = {0, -1.5, -2};
  const TissueState at_rest = rest_tissue(*model);
  const TissueState hasty = follow(*model, at_rest, X_CM, {.max_iterations = 3});
  const TissueState whole = follow(*model, at_rest, X_CM);
  const TissueState from_hasty = settle(*model, hasty), from_whole = settle(*model, whole);
  EXPECT_GT(largest_way(hasty.nodes, whole.nodes), 0.05);
  EXPECT_TRUE(from_hasty.converged && from_whole.converged);
  EXPECT_LT(largest_way(from_hasty.nodes, from_whole.nodes), 3 * settled_mm);
  const TissueState again = settle(*model, from_whole);
  EXPECT_LT(largest_way(again.nodes, from_whole.nodes), settled_mm);
  EXPECT_EQ(settle(*model, hasty, settled_mm, 2).nodes, from_hasty.nodes);
}

TEST(TenSteps, SettlingSaysWhenItHasNotEnded) {
  const auto model = build_tissue(builtin(), {.surface_nodes = 150});
  Pose X_CM;
  X_CM.t = {0, -0.5, -1};
  const TissueState state = follow(*model, rest_tissue(*model), X_CM);
  EXPECT_TRUE(settle(*model, state).converged);
  EXPECT_FALSE(settle(*model, state, 1e-16).converged);
}

}  // namespace
}  // namespace condyle::test
