// One patient, plan after plan: what is kept must not change the answer.
#include "sim/prediction/predictor.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.h"
#include "tests/support/builtin.h"

namespace condyle {
namespace {

/// The chin cut free and moved forward and to the left.
Plan moved_chin(const Case& patient, double forward_mm, double left_mm = 0, double kerf_mm = 0) {
  Plan plan{.name = "test", .geometry = geometry_of(patient)};
  plan =
      with_step(plan, CutStep{.osteotomy = "genioplasty", .kerf_mm = kerf_mm, .pieces = {"chin"}});
  return with_step(plan,
                   MoveStep{"chin", ClinicalMove{.left_mm = left_mm, .forward_mm = forward_mm}});
}

double distance(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) {
  EXPECT_EQ(a.size(), b.size());
  float most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

TEST(Predictor, ManySmallChangesEndAtTheFaceOfAFreshPrediction) {
  const Case& patient = test::builtin();
  Predictor predictor(patient);
  Prediction last;
  for (const double mm : {5.0, 5.5, 6.0}) last = predictor.predict(moved_chin(patient, mm, 6 - mm));
  const Prediction fresh = predict(patient, moved_chin(patient, 6));
  EXPECT_EQ(last.before, fresh.before);
  EXPECT_GT(fresh.max_displacement_mm(), 3);
  EXPECT_TRUE(last.state.converged);
  EXPECT_EQ(last.state.inverted_prisms, 0);
  EXPECT_EQ(last.after, fresh.after);
  // The bones lie where the plan puts them.
  ASSERT_EQ(last.operated.poses.X_CB.size(), fresh.operated.poses.X_CB.size());
  for (std::size_t b = 0; b < last.operated.poses.X_CB.size(); ++b)
    EXPECT_TRUE(bit_identical(last.operated.poses.X_CB[b], fresh.operated.poses.X_CB[b]));
  EXPECT_EQ(last.operated.notes, fresh.operated.notes);
}

TEST(Predictor, OtherCutsGiveTheFaceOfAFreshPredictionBitForBit) {
  const Case& patient = test::builtin();
  Predictor predictor(patient);
  predictor.predict(moved_chin(patient, 4));
  const Plan recut = moved_chin(patient, 4, 0, 0.5);
  EXPECT_EQ(predictor.predict(recut).after, predict(patient, recut).after);
}

TEST(Predictor, BackAtRestTheFaceIsTheSame) {
  const Case& patient = test::builtin();
  Predictor predictor(patient);
  EXPECT_GT(predictor.predict(moved_chin(patient, 4)).max_displacement_mm(), 2);
  const Prediction rest = predictor.predict(moved_chin(patient, 0));
  EXPECT_EQ(rest.before, rest.after);
}

TEST(Predictor, ADraggedSegmentTakesTheFaceAlongAndSettlesWhereThePlanDoes) {
  const Case& patient = test::builtin();
  Predictor predictor(patient);
  EXPECT_THROW(predictor.move({}), InputError);
  const Operated& operated = predictor.prepare(moved_chin(patient, 5));
  MovedFace face;
  for (const double fraction : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
    face = predictor.move(BodyPoses(poses_at(operated, fraction)));
    EXPECT_FALSE(face.state.reused);
    EXPECT_EQ(face.state.inverted_prisms, 0);
  }
  const Prediction settled = predictor.predict(moved_chin(patient, 5)),
                   fresh = predict(patient, moved_chin(patient, 5));
  // A frame of a drag ends with contacts exact to 0.1 mm.
  EXPECT_LT(distance(face.vertices, fresh.after), 0.5);
  EXPECT_GT(distance(face.vertices, fresh.before), 3);
  EXPECT_EQ(settled.after, fresh.after);
}

TEST(Predictor, FacesAreBitIdenticalForAnyNumberOfThreads) {
  const Case& patient = test::builtin();
  PredictionSettings alone, together;
  alone.threads = 1;
  together.threads = 3;
  Predictor one(patient, alone), three(patient, together);
  for (const double mm : {3.0, 3.5})
    EXPECT_EQ(one.predict(moved_chin(patient, mm)).after,
              three.predict(moved_chin(patient, mm)).after);
}

/// Contact with the sharp rim of the cut used to oscillate.
TEST(Predictor, LipAndAlarBaseSettleOnTheRimOfALeFortCut) {
  const Case& patient = test::builtin();
  Plan plan{.name = "test", .geometry = geometry_of(patient)};
  plan = with_step(plan, CutStep{.osteotomy = "le_fort_1", .pieces = {"maxilla"}});
  plan = with_step(plan, MoveStep{"maxilla", ClinicalMove{.forward_mm = 5}});
  const Prediction prediction = predict(patient, plan);
  EXPECT_EQ(prediction.state.inverted_prisms, 0);
  EXPECT_TRUE(prediction.state.converged);
  EXPECT_EQ(prediction.unsettled_mm, 0);
}

}  // namespace
}  // namespace condyle
