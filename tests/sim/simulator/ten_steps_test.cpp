// Where tissue comes to lie does not depend on the steps that took it there, on real anatomy.
#include "sim/tissue/ten_steps.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "sim/tissue/lips.h"
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
  const auto apart = [](const TissueState& a, const TissueState& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.nodes.size(); ++i)
      most = std::max(most, (a.nodes[i] - b.nodes[i]).norm());
    return most;
  };
  EXPECT_GT(apart(hasty, whole), 0.05);
  EXPECT_TRUE(from_hasty.converged && from_whole.converged);
  EXPECT_LT(apart(from_hasty, from_whole), 3 * settled_mm);
  const TissueState again = settle(*model, from_whole);
  EXPECT_LT(apart(again, from_whole), settled_mm);
}

}  // namespace
}  // namespace condyle::test
