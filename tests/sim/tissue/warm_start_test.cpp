// What flows from frame to frame is the state; what makes the next solve short lives beside it.
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "sim/tissue/pieces.h"
#include "tests/sim/tissue/plain_patient.h"
#include "tests/support/jaw_pose.h"

namespace condyle::test {
namespace {

std::shared_ptr<const TissueModel> small_model() {
  Case patient = plain_patient();
  part_lips(patient);
  return build_tissue(patient, {.surface_nodes = 260});
}

struct Opened {
  TissueState state;
  TissueWarmStart warm;
};
Opened opened(const TissueModel& model, int degrees) {
  Opened at{rest_tissue(model), {}};
  for (int i = 1; i <= degrees; ++i)
    at.state = solve_tissue(model, at.state, jaw_at(opening(plain_patient(), i)), {}, at.warm);
  return at;
}

TEST(TissueWarmStart, ACopyContinuesBitIdentically) {
  const auto model = small_model();
  Opened one = opened(*model, 6), two = one;
  for (int i = 7; i <= 9; ++i) {
    const auto X_CB = jaw_at(opening(plain_patient(), i));
    one.state = solve_tissue(*model, one.state, X_CB, {}, one.warm);
    two.state = solve_tissue(*model, two.state, X_CB, {}, two.warm);
    EXPECT_EQ(one.state.nodes, two.state.nodes);
    EXPECT_EQ(one.state.iterations, two.state.iterations);
  }
}

TEST(TissueWarmStart, WithoutOneTheAnswerIsAsGood) {
  const auto model = small_model();
  Opened at = opened(*model, 6);
  const auto X_CB = jaw_at(opening(plain_patient(), 7));
  const TissueState fresh = solve_tissue(*model, at.state, X_CB);
  at.state = solve_tissue(*model, at.state, X_CB, {}, at.warm);
  EXPECT_TRUE(fresh.converged && at.state.converged);
  EXPECT_LT(largest_displacement(fresh.nodes, at.state.nodes), 0.2);
}

TEST(TissueWarmStart, OneOfOtherObstaclesOrOfAnotherMeshIsNotUsed) {
  const auto model = small_model(), other = small_model();
  const auto X_CB = jaw_at(opening(plain_patient(), 3));
  const TissueState alone = solve_tissue(*model, rest_tissue(*model), X_CB);
  TissueWarmStart of_other = opened(*other, 6).warm;
  EXPECT_EQ(solve_tissue(*model, rest_tissue(*model), X_CB, {}, of_other).nodes, alone.nodes);
}

TEST(TissueWarmStart, AFailedSolveLeavesItAsItWas) {
  const auto model = small_model();
  Opened at = opened(*model, 3);
  const auto before = at.warm.last;
  Pose nowhere;
  nowhere.t.x() = std::nan("");
  EXPECT_TRUE(solve_tissue(*model, at.state, jaw_at(nowhere), {}, at.warm).reused);
  EXPECT_EQ(at.warm.last, before);
}

TEST(Pieces, NoCutChangesNothing) {
  const auto model = small_model();
  const auto same = carry_to_pieces(*model, {});
  const auto X_CB = jaw_at(opening(plain_patient(), 6));
  EXPECT_EQ(solve_tissue(*same, rest_tissue(*same), X_CB).nodes,
            solve_tissue(*model, rest_tissue(*model), X_CB).nodes);
}

TEST(Pieces, OwnersMustMatchTheSurfaceAndNamePieces) {
  const auto model = small_model();
  const TriMesh bone = plain_patient().find(Role::mandible)->mesh;
  CutBone cut{BodyId{1}, bone, {}, {{BodyId{1}, bone}}};
  EXPECT_THROW(carry_to_pieces(*model, {&cut, 1}), InputError);
  cut.owner.assign(bone.triangles.size(), BodyId{3});
  EXPECT_THROW(carry_to_pieces(*model, {&cut, 1}), InputError);
  cut.owner.assign(bone.triangles.size(), BodyId{1});
  EXPECT_TRUE(carry_to_pieces(*model, {&cut, 1}));
}

// All of a bone that becomes one piece of another number is the same bone.
TEST(Pieces, AWholeBoneAsOnePieceAnswersAsBefore) {
  const auto model = small_model();
  Case patient = plain_patient();
  const TriMesh bone = patient.find(Role::mandible)->mesh;
  const CutBone cut{
      BodyId{1}, bone, std::vector<BodyId>(bone.triangles.size(), BodyId{3}), {{BodyId{3}, bone}}};
  JawBodies jaw;
  jaw.lower_arch = jaw.left_condyle = jaw.right_condyle = BodyId{3};
  const auto renamed = carry_to_pieces(*model, {&cut, 1}, jaw);
  const Pose X_CM = opening(patient, 6);
  const std::array X_CB{Pose{}, Pose{}, Pose{}, X_CM};
  EXPECT_LT(largest_displacement(solve_tissue(*renamed, rest_tissue(*renamed), X_CB).nodes,
                                 solve_tissue(*model, rest_tissue(*model), jaw_at(X_CM)).nodes),
            1e-6);
}

}  // namespace
}  // namespace condyle::test
