#include "sim/prediction/prediction.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "engine/core/error.h"
#include "sim/prediction/soft_ratios.h"
#include "tests/support/builtin.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Plan plan_of(const Case& patient) { return {.name = "test", .geometry = geometry_of(patient)}; }

/// The chin cut free, and moved.
Plan chin_plan(const Case& patient, double forward_mm) {
  Plan plan = with_step(plan_of(patient),
                        CutStep{.osteotomy = "genioplasty", .kerf_mm = 0, .pieces = {"chin"}});
  if (forward_mm == 0) return plan;
  return with_step(plan, MoveStep{"chin", ClinicalMove{.forward_mm = forward_mm}});
}

TEST(Prediction, OfAnEmptyPlanIsTheSameFace) {
  const Case& patient = test::builtin();
  const Prediction prediction = predict(patient, plan_of(patient));
  EXPECT_EQ(prediction.before, prediction.after);
  EXPECT_EQ(prediction.before.size(), prediction.face.vertices.size());
  for (const auto& point : prediction.points) EXPECT_EQ(point.before, point.after);
  EXPECT_TRUE(soft_ratios(prediction, clinical_frame(patient.landmarks)).empty());
}

TEST(Prediction, ASawThatMovesNothingLeavesTheFace) {
  const Case& patient = test::builtin();
  const Prediction prediction = predict(patient, chin_plan(patient, 0));
  ASSERT_EQ(prediction.operated.cuts.size(), 1U);
  EXPECT_LT(prediction.max_displacement_mm(), 1e-3);
}

TEST(Prediction, AChinThatAdvancesTakesTheSkinAlong) {
  const Case& patient = test::builtin();
  const Plan plan = chin_plan(patient, 8);
  const Prediction prediction = predict(patient, plan);
  EXPECT_EQ(prediction.state.inverted_prisms, 0);
  EXPECT_TRUE(prediction.state.converged);
  const ClinicalFrame frame = clinical_frame(patient.landmarks);
  bool found = false;
  for (const SoftRatio& row : soft_ratios(prediction, frame)) {
    if (row.soft != "soft_pogonion") continue;
    found = true;
    EXPECT_NEAR(row.hard_mm, 8, 1e-9);
    EXPECT_GT(row.soft_mm, 4);
    EXPECT_LT(row.soft_mm, 9);
    std::printf("chin 8 mm forward: soft pogonion %.2f mm\n", row.soft_mm);
  }
  EXPECT_TRUE(found);
  for (const auto& [name, before, after] : prediction.points)
    if (name == "pronasale") {
      EXPECT_LT((after - before).norm(), 0.3) << "the nose stays";
    }
}

TEST(Prediction, OneStepAndTenEndAtTheSameFace) {
  const Case& patient = test::builtin();
  const Plan plan = chin_plan(patient, 4);
  PredictionSettings one, ten;
  one.steps = 1;
  const Prediction a = predict(patient, plan, one), b = predict(patient, plan, ten);
  double most = 0;
  for (std::size_t i = 0; i < a.after.size(); ++i)
    most = std::max<double>(most, (a.after[i] - b.after[i]).norm());
  std::printf("one step and ten differ by %.4f mm\n", most);
  EXPECT_LT(most, 0.05);
}

TEST(Prediction, OfAPatientWithoutAFaceIsRefused) {
  Case patient = test::builtin();
  std::erase_if(patient.parts, [](const Part& part) { return part.role == Role::face; });
  EXPECT_THROW(predict(patient, plan_of(patient)), InputError);
}

}  // namespace
}  // namespace condyle
