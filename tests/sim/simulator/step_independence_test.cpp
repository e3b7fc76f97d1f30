// The state of tissue does not depend on the steps that led there, on real anatomy.
#include "tools/bench/baseline/step_independence.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "tests/support/builtin.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/scan_case.h"

namespace condyle::test {
namespace {

void expect_same_tissue(Case patient) {
  part_lips(patient);
  const auto model = build_tissue(patient);
  for (double opened_deg : {2.0, 5.0, 14.0, 22.0, 25.0}) {
    const StepIndependence steps = step_independence(*model, opened_deg * std::numbers::pi / 180);
    std::printf("opened by %.0f degrees: ten steps end %.4f mm from one (as frames end: %.2f mm)\n",
                opened_deg, steps.difference_mm, steps.of_frames_mm);
    EXPECT_TRUE(steps.settled) << opened_deg;
    EXPECT_GT(steps.moved_mm, 0.8) << opened_deg;
    EXPECT_LT(steps.difference_mm, 0.01) << opened_deg;
  }
}

TEST(StepIndependence, EqualOneStepInTheBuiltInPatient) { expect_same_tissue(builtin()); }

TEST(StepIndependence, EqualOneStepInARealPatient) {
  const auto patient = case_badin_with_face();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_same_tissue(*patient);
}

// A frame of a few iterations stops far from where the tissue belongs.
TEST(StepIndependence, EquilibriumIsUniqueFromAnyStart) {
  const Case& patient = builtin();
  const auto model = build_tissue(patient);
  Pose X_CM;
  X_CM.t = {0, -1.5, -2};
  const TissueState at_rest = rest_tissue(*model);
  const TissueState hasty = solve_tissue(*model, at_rest, jaw_at(X_CM), {.max_iterations = 3});
  const TissueState whole = solve_tissue(*model, at_rest, jaw_at(X_CM));
  const TissueState from_hasty = solve_to_equilibrium(*model, hasty),
                    from_whole = solve_to_equilibrium(*model, whole);
  EXPECT_GT(largest_displacement(hasty.nodes, whole.nodes), 0.05);
  EXPECT_TRUE(from_hasty.converged && from_whole.converged);
  EXPECT_LT(largest_displacement(from_hasty.nodes, from_whole.nodes), 3 * equilibrium_mm);
  const TissueState again = solve_to_equilibrium(*model, from_whole);
  EXPECT_LT(largest_displacement(again.nodes, from_whole.nodes), equilibrium_mm);
  EXPECT_EQ(solve_to_equilibrium(*model, hasty, equilibrium_mm, 2).nodes, from_hasty.nodes);
}

TEST(StepIndependence, AnUnconvergedSolveIsReported) {
  const auto model = build_tissue(builtin(), {.surface_nodes = 150});
  Pose X_CM;
  X_CM.t = {0, -0.5, -1};
  const TissueState state = solve_tissue(*model, rest_tissue(*model), jaw_at(X_CM));
  EXPECT_TRUE(solve_to_equilibrium(*model, state).converged);
  EXPECT_FALSE(solve_to_equilibrium(*model, state, 1e-16).converged);
}

}  // namespace
}  // namespace condyle::test
