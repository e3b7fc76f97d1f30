// The face over bone that was resected, grafted or trimmed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/mesh/measure.h"
#include "sim/prediction/prediction.h"
#include "sim/prediction/predictor.h"
#include "sim/tissue/model.h"
#include "tests/support/builtin.h"
#include "tests/support/reconstruction.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Largest displacement of the face to the left within a distance of a point at rest.
double most_to_the_left(const Prediction& prediction, const Vector3d& near, double within_mm) {
  double most = 0;
  for (std::size_t i = 0; i < prediction.before.size(); ++i)
    if ((prediction.before[i].cast<double>() - near).norm() < within_mm)
      most = std::max<double>(most, prediction.after[i].x() - prediction.before[i].x());
  return most;
}

TEST(Resection, HoldsNoTissueWhereTheBoneWas) {
  const Case& patient = test::builtin();
  const Prediction prediction = predict(patient, test::resection_plan(patient));
  ASSERT_EQ(prediction.operated.resections.size(), 1U);
  EXPECT_EQ(prediction.before, prediction.after) << "nothing presses and nothing moves";
  EXPECT_GT(prediction.stripping.resected, 10);

  const TissueModel& tissue = *prediction.tissue;
  const Vector3d middle = bounding_box(prediction.operated.resections[0].bone).center();
  int loose = 0;
  double least = 1;
  for (std::size_t i = 0; i < prediction.stripping.kept.size(); ++i) {
    const double kept = prediction.stripping.kept[i];
    if (kept > prediction.stripping.settings.resected) continue;
    ++loose;
    least = std::min(least, kept);
    const Vector3d& p = tissue.mesh->rest[tissue.mesh->elements.anchor_node[i]];
    EXPECT_LT((p - middle).norm(), 40) << "only beside the resected bone";
  }
  EXPECT_EQ(loose, prediction.stripping.resected);
  EXPECT_GT(least, 0);
}

/// A graft within the outline of the bone leaves the face; one that protrudes pushes the skin.
TEST(Resection, AGraftThatProtrudesPushesTheSkin) {
  const Case& patient = test::builtin();
  GraftStep graft = test::fibula_graft(1);
  const Plan plan = test::resection_plan(patient);
  Predictor predictor(patient);
  const Prediction inside = predictor.predict(with_step(plan, graft));
  ASSERT_EQ(inside.operated.grafts.size(), 1U);
  const GraftLayout& laid = inside.operated.grafts[0];
  ASSERT_EQ(laid.pieces.size(), 1U);
  const Vector3d middle = bounding_box(laid.pieces[0].mesh).center();

  graft.curve = laid.curve;
  for (Vector3d& p : graft.curve) p.x() += 5;
  const Prediction outside = predictor.predict(with_step(plan, graft));
  const double a = most_to_the_left(inside, middle, 30), b = most_to_the_left(outside, middle, 30);
  std::printf("skin over the graft: %.2f mm; 5 mm farther out: %.2f mm\n", a, b);
  EXPECT_LT(a, 1);
  EXPECT_GT(b, a + 1.5);
  EXPECT_LT(b, 7);
  for (const Prediction* prediction : {&inside, &outside}) {
    EXPECT_EQ(prediction->state.inverted_prisms, 0);
    EXPECT_LT(prediction->unsettled_mm, 0.1);
    EXPECT_LT(prediction->state.penetration_mm, 0.2);
  }
}

TEST(Trimming, StripsTheTissueBesideTheTrimmedFaces) {
  const Case& patient = test::builtin();
  Plan plan{.name = "trim", .geometry = geometry_of(patient)};
  plan = with_step(plan, CutStep{.osteotomy = "sagittal_split",
                                 .pieces = {"proximal_left", "proximal_right", "distal"}});
  plan = with_step(plan, MoveStep{"distal", ClinicalMove{.forward_mm = -5}});
  Predictor predictor(patient);
  predictor.prepare(plan);
  const int cut = predictor.stripping().stripped();
  TrimStep trim;
  trim.segment = "distal";
  trim.of = {"proximal_left", "proximal_right"};
  plan = with_step(plan, trim);
  const Operated& operated = predictor.prepare(plan);
  ASSERT_EQ(operated.trims.size(), 1U);
  EXPECT_GT(operated.trims[0].removed_mm3(), 100);
  std::printf("stripped %d, with the trim %d\n", cut, predictor.stripping().stripped());
  EXPECT_GT(predictor.stripping().stripped(), cut);
}

}  // namespace
}  // namespace condyle
