// Brows and forehead of the built-in patient under their muscles.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/case/eyes.h"
#include "sim/muscles/default_face_muscles.h"
#include "sim/muscles/expression.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/engine/mesh_io/samples.h"
#include "tests/support/builtin.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct BrowFace {
  Case patient = test::builtin();
  std::vector<FaceMuscle> muscles;
  std::shared_ptr<const TissueModel> model;

  explicit BrowFace(bool upper_face) {
    part_lips(patient);
    muscles = muscles_of_face(patient);
    model = build_tissue(patient, {.upper_face = upper_face, .face_muscles = muscles});
  }
  /// The end of an expression in steps of 25 ms.
  TissueState shows(const std::string& spec) const {
    const Expression expression = make_expression(spec, muscles);
    TissueState state = rest_tissue(*model);
    TissueWarmStart warm;
    for (int i = 1; i <= 24; ++i) {
      state = solve_tissue(*model, state, {}, {}, warm, expression.at(0.025 * i).muscles);
      EXPECT_EQ(state.inverted_prisms, 0) << spec << " at " << i;
      EXPECT_FALSE(state.reused) << spec << " at " << i;
    }
    return state;
  }
  Vector3d moved(const TissueState& state, const Vector3d& at) const {
    return carried_point(*model, state, at) - carried_point(*model, rest_tissue(*model), at);
  }
  Eyes eyes() const { return *find_eyes(patient.find(Role::face)->mesh, patient.landmarks); }
};

const BrowFace& brow_face() {
  static const BrowFace face(true);
  return face;
}

const Vector3d above_eye(0, -9, 21);

/// The eyes of a face whose openings alone are known. The caruncles are of the face, so that the
/// openings end lateral to the inner canthi.
TEST(Eyes, AreFoundByTheirOpenings) {
  const Case& patient = test::builtin();
  const TriMesh& mesh = patient.find(Role::face)->mesh;
  const auto marked = find_eyes(mesh, patient.landmarks), opened = find_eyes(mesh, {});
  ASSERT_TRUE(marked && opened);
  for (const auto& [a, b] :
       {std::pair(marked->left, opened->left), std::pair(marked->right, opened->right)}) {
    EXPECT_LT((a.inner - b.inner).norm(), 9);
    EXPECT_LT((a.outer - b.outer).norm(), 4);
    EXPECT_LT((a.globe - b.globe).norm(), 5);
  }
  EXPECT_GT(opened->left.outer.x(), opened->left.inner.x());
  EXPECT_LT(opened->right.outer.x(), opened->right.inner.x());
  EXPECT_FALSE(find_eyes(test::cuboid({-70, -60, -80}, {70, 70, 110}), {}));
  Landmarks one_place = patient.landmarks;
  for (const char* canthus : {"left_endocanthion", "left_exocanthion"})
    one_place.points[canthus] = Vector3d(30, -80, 14);
  EXPECT_FALSE(find_eyes(mesh, one_place));
}

// Source of the ranges: Vicon measurements, see expression_findings.cpp.
TEST(UpperFace, SurpriseLiftsTheBrowsAndLeavesTheLidsOnTheEyes) {
  const BrowFace& face = brow_face();
  const TissueState surprise = face.shows("surprise");
  const Eyes eyes = face.eyes();
  for (const Eye& eye : {eyes.left, eyes.right}) {
    const Vector3d middle = 0.5 * (eye.inner + eye.outer);
    const double up = face.moved(surprise, middle + above_eye).z();
    EXPECT_GT(up, 8.1);
    EXPECT_LT(up, 13.1);
    EXPECT_LT(face.moved(surprise, eye.inner).norm(), 1);
    EXPECT_LT(face.moved(surprise, eye.outer).norm(), 1);
    EXPECT_LT(face.moved(surprise, middle + Vector3d(0, -9, -4)).norm(), 0.7);  // lower lid
    EXPECT_LT(face.moved(surprise, middle + Vector3d(0, -9, 4.5)).norm(), 1.5);
  }
  EXPECT_LT(face.moved(surprise, *face.patient.landmarks.find("left_cheilion")).norm(), 0.1);
}

TEST(UpperFace, AFrownDrawsTheBrowsTogetherAndDown) {
  const BrowFace& face = brow_face();
  const TissueState frown = face.shows("AU4");
  const Eyes eyes = face.eyes();
  const Vector3d left = face.moved(frown, eyes.left.inner + above_eye + Vector3d(3, 0, 0)),
                 right = face.moved(frown, eyes.right.inner + above_eye - Vector3d(3, 0, 0));
  EXPECT_GT(left.norm(), 4.3);
  EXPECT_LT(left.norm(), 10.9);
  EXPECT_GT(right.norm(), 4.3);
  EXPECT_LT(right.norm(), 10.9);
  EXPECT_LT(left.x(), -0.5);
  EXPECT_GT(right.x(), 0.5);
  EXPECT_LT(left.z(), -1);
  EXPECT_LT(right.z(), -1);
}

TEST(UpperFace, MovesOnTheExcitedSideOnly) {
  const BrowFace& face = brow_face();
  const TissueState state = face.shows("AU2:1:right");
  const Eyes eyes = face.eyes();
  EXPECT_GT(face.moved(state, 0.5 * (eyes.right.inner + eyes.right.outer) + above_eye).z(), 3);
  EXPECT_LT(face.moved(state, 0.5 * (eyes.left.inner + eyes.left.outer) + above_eye).norm(), 1);
}

TEST(UpperFace, IsNotPulledWhereTheTissueEndsBelowTheEyes) {
  const BrowFace face(false);
  const TissueState state = face.shows("surprise");
  EXPECT_EQ(state.nodes, rest_tissue(*face.model).nodes);
}

}  // namespace
}  // namespace condyle
