#include "sim/simulator/live_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/boxes.h"

namespace condyle::test {
namespace {

/// Drops by 20 mm in 2 s and comes up again in the next 2 s.
Motion nodding() {
  return {"nodding",
          4.0,
          false,
          [](double t) {
            Pose pose;
            const double time_s = std::clamp(t, 0.0, 4.0);
            pose.t = {0, 0, -10 * std::min(time_s, 4 - time_s)};
            return pose;
          },
          {}};
}

}  // namespace

TEST(OpeningTimes, AnswerTheFirstTimeOfEachOpeningInAnyOrder) {
  const Case patient = box_patient();
  const Motion motion = nodding();
  OpeningTimes times(patient, motion);
  for (const double opening_mm : {3.0, 19.0, 0.5, 12.25, 3.0})
    EXPECT_NEAR(times.time_of(opening_mm), opening_mm / 10, 1e-9) << opening_mm;
  EXPECT_NEAR(times.time_of(40), 2, 4.0 / 200) << "it opens less: where it is widest";
}

TEST(LiveBudget, GrowsWhileTissueSettlesAndIsWholeWhereTheJawLeapsOrASolveFailed) {
  const TissueBudget keeping_up{.max_iterations = 3};
  const int whole = TissueBudget{}.max_iterations;
  EXPECT_EQ(live_budget(keeping_up, false, false, false).max_iterations, 3);
  const int settling = live_budget(keeping_up, true, false, false).max_iterations;
  EXPECT_GT(settling, 3);
  EXPECT_LT(settling, whole);
  EXPECT_TRUE(live_budget(keeping_up, true, false, false).damped_contact);
  EXPECT_FALSE(live_budget(keeping_up, false, false, false).damped_contact);
  EXPECT_EQ(live_budget(keeping_up, false, true, false).max_iterations, whole);
  EXPECT_EQ(live_budget(keeping_up, true, false, true).max_iterations, whole);
}

TEST(LiveSteps, RunOnInFixedStepsAndAreDueUntilTheTargetIsReached) {
  const Scene scene = make_scene(box_patient());
  const Motion motion = nodding();
  const SimulatorSettings settings = live_settings({});
  LiveSteps steps(scene, motion, motion, settings);
  LiveTarget target{
      .request = {.time_s = 6 * settings.step_s},
      .X_PB_held = std::vector<std::optional<Pose>>(scene.patient.bodies.bodies().size())};
  int taken = 0;
  for (; steps.due(target.request, target.grips) && taken < 20; ++taken) steps.step(target, true);
  EXPECT_EQ(taken, 6);
  EXPECT_NEAR(steps.frame().time_s, target.request.time_s, 1e-12);
  target.request.time_s = 3;  // a jump
  EXPECT_TRUE(steps.due(target.request, target.grips));
  EXPECT_FALSE(steps.runs_on(target.request));
  steps.step(target, true);
  EXPECT_FALSE(steps.due(target.request, target.grips));
  EXPECT_TRUE(steps.due(target.request, target.grips + 1)) << "a hand has moved";
}

}  // namespace condyle::test
