// Muscles of the face in the built-in patient's tissue.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/muscles/default_face_muscles.h"
#include "sim/muscles/expression.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/support/builtin.h"
#include "tests/support/jaw_pose.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct MuscledFace {
  Case patient = test::builtin();
  std::shared_ptr<const TissueModel> model;
  std::vector<FaceMuscle> muscles;

  explicit MuscledFace(bool with_muscles = true) {
    part_lips(patient);
    TissueSettings settings;
    if (with_muscles) settings.face_muscles = default_face_muscles(patient);
    muscles = settings.face_muscles;
    model = build_tissue(patient, settings);
  }
  Vector3d moved(const TissueState& state, const char* landmark) const {
    const Vector3d at = *patient.landmarks.find(landmark);
    return carried_point(*model, state, at) - carried_point(*model, rest_tissue(*model), at);
  }
};

const MuscledFace& muscled_face() {
  static const MuscledFace face;
  return face;
}

/// The end of an expression in steps of 10 ms.
TissueState state_of(const MuscledFace& face, const std::string& spec, int threads = 2) {
  const Expression expression = make_expression(spec, face.muscles);
  TissueState state = rest_tissue(*face.model);
  TissueWarmStart warm;
  TissueBudget budget;
  budget.threads = threads;
  for (int i = 1; i <= 60; ++i) {
    state = solve_tissue(*face.model, state, {}, budget, warm, expression.at(0.01 * i));
    EXPECT_EQ(state.inverted_prisms, 0) << spec << " at " << i;
    EXPECT_FALSE(state.reused) << spec << " at " << i;
  }
  return state;
}

TEST(FaceMuscles, WithoutExcitationChangeNothingBitForBit) {
  const MuscledFace& with = muscled_face();
  const MuscledFace without(false);
  ASSERT_GT(with.muscles.size(), 10u);
  const std::vector<double> none(with.muscles.size(), 0.0);
  const auto poses = test::jaw_at(Pose{.R = Eigen::Quaterniond::Identity(), .t = {0, -1, -3}});
  TissueWarmStart warm, warm_without;
  const TissueState a = solve_tissue(*with.model, rest_tissue(*with.model), poses, {}, warm, none);
  const TissueState b =
      solve_tissue(*without.model, rest_tissue(*without.model), poses, {}, warm_without);
  EXPECT_GT((a.nodes[0] - rest_tissue(*with.model).nodes[0]).norm() + a.iterations, 0);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.iterations, b.iterations);
}

// Source of the ranges: measured and simulated smiles, see expression_findings.cpp.
TEST(FaceMuscles, ASmileIsThatOfHealthyPeople) {
  const MuscledFace& face = muscled_face();
  const TissueState smile = state_of(face, "smile");
  EXPECT_LT(smile.penetration_mm, 0.2);
  for (const auto& [mark, sign] :
       {std::pair("left_cheilion", 1), std::pair("right_cheilion", -1)}) {
    const Vector3d moved = face.moved(smile, mark);
    EXPECT_GT(moved.norm(), 9) << mark;
    EXPECT_LT(moved.norm(), 14) << mark;
    const double angle = std::atan2(moved.z(), sign * moved.x()) * 180 / 3.14159265;
    EXPECT_GT(angle, 35) << mark;
    EXPECT_LT(angle, 60) << mark;
    EXPECT_GT(moved.y(), 0) << mark << ": back along the teeth";
  }
  const auto length = face_muscle_lengths(*face.model, smile),
             rest = face_muscle_lengths(*face.model, rest_tissue(*face.model));
  int zygomatic = 0;
  for (std::size_t m = 0; m < length.size(); ++m)
    if (face.muscles[m].kind == "zygomaticus_major") {
      ++zygomatic;
      EXPECT_GT(length[m] / rest[m], 0.82);
      EXPECT_LT(length[m] / rest[m], 0.89);
    }
  EXPECT_EQ(zygomatic, 2);
}

TEST(FaceMuscles, OneSideMovesThatCornerOnly) {
  const MuscledFace& face = muscled_face();
  const TissueState left = state_of(face, "smile:1:left");
  EXPECT_GT(face.moved(left, "left_cheilion").norm(), 8);
  EXPECT_LT(face.moved(left, "right_cheilion").norm(), 1.5);
}

TEST(FaceMuscles, SadnessDrawsTheCornersDown) {
  const MuscledFace& face = muscled_face();
  const TissueState sad = state_of(face, "sad");
  EXPECT_LT(face.moved(sad, "left_cheilion").z(), -2);
  EXPECT_LT(face.moved(sad, "right_cheilion").z(), -2);
}

TEST(FaceMuscles, AreBitIdenticalForOneAndTwoThreads) {
  const MuscledFace& face = muscled_face();
  EXPECT_EQ(state_of(face, "smile:0.6", 1).nodes, state_of(face, "smile:0.6", 2).nodes);
}

TEST(FaceMuscles, AreLeftOutWithoutTheirLandmarks) {
  Case patient = test::builtin();
  patient.landmarks.points.erase("left_malar");
  EXPECT_EQ(missing_face_landmark(patient), "left_malar");
  EXPECT_TRUE(default_face_muscles(patient).empty());
}

}  // namespace
}  // namespace condyle
