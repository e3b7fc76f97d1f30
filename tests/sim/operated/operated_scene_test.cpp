#include "sim/operated/operated_scene.h"

#include <gtest/gtest.h>

#include "sim/frame/body_poses.h"
#include "sim/prediction/prediction.h"
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

}  // namespace condyle
