#include "sim/operated/operated_scene.h"

#include <gtest/gtest.h>

#include "sim/frame/body_poses.h"
#include "sim/muscles/default_face_muscles.h"
#include "sim/muscles/expression.h"
#include "sim/prediction/prediction.h"
#include "sim/tissue/model.h"
#include "tests/support/builtin.h"

namespace condyle {
namespace {

Plan empty_plan() { return {.name = "test", .geometry = geometry_of(test::builtin())}; }

/// The chin cut free and advanced.
Plan chin_plan() {
  Plan plan = with_step(empty_plan(), CutStep{.osteotomy = "genioplasty", .pieces = {"chin"}});
  return with_step(plan, MoveStep{"chin", ClinicalMove{.forward_mm = 6}});
}

const Scene& operated_scene() {
  static const Scene scene = make_operated_scene(test::builtin(), chin_plan());
  return scene;
}

}  // namespace

TEST(OperatedScene, WithoutStepsIsTheUncutPatient) {
  const OperatedPatient same = operate(test::builtin(), empty_plan());
  EXPECT_FALSE(same.changed);
  EXPECT_EQ(geometry_of(same.patient), geometry_of(test::builtin()));
}

TEST(OperatedScene, TheFaceAtRestIsThePredictedOne) {
  const Prediction prediction = predict(test::builtin(), chin_plan());
  const Scene& scene = operated_scene();
  FrameState rest = rest_frame(scene);
  carry_face(scene, rest, 2);
  ASSERT_EQ(rest.face.size(), prediction.after.size());
  double most = 0;
  for (std::size_t i = 0; i < rest.face.size(); ++i)
    most = std::max<double>(most, (rest.face[i] - prediction.after[i]).norm());
  EXPECT_LT(most, 0.01);
  EXPECT_GT(prediction.max_displacement_mm(), 4);
}

TEST(OperatedScene, TheChinOpensWithTheJawAboutTheSameCondyles) {
  const Scene& scene = operated_scene();
  const Case& patient = scene.patient;
  const auto chin = patient.bodies.find("chin");
  ASSERT_TRUE(chin);
  EXPECT_EQ(patient.bodies[*chin].parent, patient.jaw.lower_arch);
  for (const char* name : {"left_condyle", "right_condyle"})
    EXPECT_EQ(*patient.landmarks.find(name), *test::builtin().landmarks.find(name));
  EXPECT_NEAR(
      (*patient.landmarks.find("pogonion") - *test::builtin().landmarks.find("pogonion")).norm(), 6,
      1e-9);
  ASSERT_TRUE(scene.plan);
  EXPECT_EQ(scene.plan->name, "test");
}

TEST(OperatedScene, TheOperatedFaceKeepsTheMusclesThatTheCaseBrings) {
  Case patient = test::builtin();
  FaceMuscle own{.name = "left_risorius", .kind = "risorius", .limit_N = 1.25, .lines = {}};
  own.lines = {{{.at = {60, -60, -50}, .depth = 0.5}, {.at = {26, -88, -50}, .depth = 0.5}}};
  patient.face_muscles = {own};
  const Scene scene = make_operated_scene(patient, chin_plan());
  const auto& muscles = face_muscles_of(*scene.tissue);
  const auto expected = muscles_of_face(patient);
  ASSERT_EQ(muscles.size(), expected.size());
  for (std::size_t m = 0; m < muscles.size(); ++m) EXPECT_EQ(muscles[m].name, expected[m].name);
  EXPECT_EQ(muscles.front().limit_N, 1.25);
}

TEST(OperatedScene, TheOperatedFaceSmilesByMusclesOnItsPieces) {
  const Scene& scene = operated_scene();
  const TissueModel& tissue = *scene.tissue;
  const auto chin = scene.patient.bodies.find("chin");
  const auto& muscles = face_muscles_of(tissue);
  ASSERT_GT(muscles.size(), 10u);
  bool chin_carries_mentalis = false;
  for (const TissueMuscles::Line& line : tissue.muscles.lines)
    for (const TissueMuscles::Point& point : line.points) {
      if (!point.bone) continue;
      EXPECT_LT(index_of(*point.bone), scene.patient.bodies.bodies().size());
      chin_carries_mentalis |= point.bone == chin;
    }
  EXPECT_TRUE(chin_carries_mentalis);
  const Expression smile = make_expression("smile", muscles);
  const TissueState rest = rest_tissue(tissue);
  TissueState state = rest;
  TissueWarmStart warm;
  for (int i = 1; i <= 25; ++i)
    state = solve_tissue(tissue, state, {}, {}, warm, smile.at(0.02 * i).muscles);
  EXPECT_EQ(state.inverted_prisms, 0);
  for (const char* corner : {"left_cheilion", "right_cheilion"}) {
    const Eigen::Vector3d at = *scene.patient.landmarks.find(corner);
    const double moved =
        (carried_point(tissue, state, at) - carried_point(tissue, rest, at)).norm();
    EXPECT_GT(moved, 8) << corner;
    EXPECT_LT(moved, 15) << corner;
  }
  // At the planned rest no muscle pulls: hardly excited ones change nothing.
  const std::vector<double> faint(muscles.size(), 1e-6);
  TissueWarmStart other, without;
  const TissueState excited = solve_tissue(tissue, rest, {}, {}, other, faint),
                    relaxed = solve_tissue(tissue, rest, {}, {}, without);
  double most = 0;
  for (std::size_t n = 0; n < excited.nodes.size(); ++n)
    most = std::max(most, (excited.nodes[n] - relaxed.nodes[n]).norm());
  EXPECT_LT(most, 0.02);
}

}  // namespace condyle
