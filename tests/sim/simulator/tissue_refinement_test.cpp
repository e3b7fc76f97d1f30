// The same layers are the same tissue at any number of nodes, on a real patient.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sim/phantom/phantom.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/scan_case.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

/// The face with the mouth opened. Four degrees lower the incisors by about 6 mm, sixteen by 22 mm.
std::vector<Eigen::Vector3f> opened_face(const Case& patient, int surface_nodes, TissueBond bond,
                                         int target_nodes, int most_degrees = 4) {
  const auto model =
      build_tissue(patient, {.surface_nodes = surface_nodes, .plan = {.bond = bond}});
  EXPECT_NEAR(summary(*model).nodes, target_nodes, 0.05 * target_nodes);
  const Vector3d condyles =
      0.5 * (*patient.landmarks.find("left_condyle") + *patient.landmarks.find("right_condyle"));
  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  for (int degrees = 1; degrees <= most_degrees; ++degrees) {
    const double slide = 0.35 * degrees;
    Pose X_CM;
    X_CM.R =
        Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector3d::UnitX()));
    X_CM.t = condyles - X_CM.R * condyles + Vector3d(0, -slide, -0.4 * slide);
    state = solve_tissue(*model, state, jaw_at(X_CM), {}, warm);
    EXPECT_TRUE(state.converged);
  }
  std::vector<Eigen::Vector3f> face;
  deform_face(*model, state, face);
  return face;
}

struct Finer {
  int surface_nodes, nodes;
};

void expect_same_tissue(TissueBond bond, Finer finer = {1400, 8400}) {
  auto patient = case_badin_with_face();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  part_lips(*patient);
  const auto coarse = opened_face(*patient, 520, bond, 2080);
  const auto fine = opened_face(*patient, finer.surface_nodes, bond, finer.nodes);
  // Over the face's area, and over its vertices, which crowd at lips and nostrils.
  const TriMesh& face = patient->find(Role::face)->mesh;
  double difference = 0, whole = 0, plain_difference = 0, plain_whole = 0, farthest = 0;
  std::vector<double> area(face.vertices.size(), 0.0);
  for (const auto& t : face.triangles) {
    const Vector3d &a = face.vertices[t[0]], &b = face.vertices[t[1]], &c = face.vertices[t[2]];
    for (int v : t) area[v] += (b - a).cross(c - a).norm() / 6;
  }
  for (std::size_t v = 0; v < area.size(); ++v) {
    const double apart = (coarse[v] - fine[v]).squaredNorm();
    const double squared = (fine[v] - face.vertices[v].cast<float>()).squaredNorm();
    difference += area[v] * apart;
    whole += area[v] * squared;
    plain_difference += apart;
    plain_whole += squared;
    farthest = std::max(farthest, std::sqrt(squared));
  }
  std::printf(
      "refined from 2,080 to %d nodes: %.1f %% of the displacement by area, %.1f %% by vertex\n",
      finer.nodes, 100 * std::sqrt(difference / whole),
      100 * std::sqrt(plain_difference / plain_whole));
  EXPECT_GT(farthest, 5);
  EXPECT_LT(std::sqrt(difference / whole), 0.05);
  EXPECT_LT(std::sqrt(plain_difference / plain_whole), 0.05);
}

TEST(TissueRefinement, FromTwoToEightThousandNodesSlidingMovesARealFaceByLessThanFivePercent) {
  expect_same_tissue(TissueBond::sliding);
}

TEST(TissueRefinement, FromTwoToTwentyThousandNodesMovesARealFaceByLessThanFivePercent) {
  expect_same_tissue(TissueBond::sliding, {3339, 20034});
}

TEST(TissueRefinement, FromTwoToEightThousandNodesGluedMovesARealFaceByLessThanFivePercent) {
  expect_same_tissue(TissueBond::glued);
}

// Measured over what moves by more than 1 mm: most of the head rests.
TEST(TissueRefinement, FromTwoToEightThousandNodesMovesTheBuiltInFaceAlikeByHalfAnOpening) {
  Case patient = builtin_patient();
  part_lips(patient);
  const auto coarse = opened_face(patient, 520, TissueBond::sliding, 2140, 16);
  const auto fine = opened_face(patient, 2000, TissueBond::sliding, 8048, 16);
  const TriMesh& face = patient.find(Role::face)->mesh;
  std::vector<double> apart;
  for (std::size_t v = 0; v < fine.size(); ++v)
    if ((fine[v] - face.vertices[v].cast<float>()).norm() > 1)
      apart.push_back((coarse[v] - fine[v]).norm());
  ASSERT_GT(apart.size(), 10000u);
  std::sort(apart.begin(), apart.end());
  const double median = apart[apart.size() / 2], p95 = apart[apart.size() * 95 / 100];
  std::printf("opened by 16 degrees: median %.2f mm, 95 %% within %.2f mm\n", median, p95);
  EXPECT_LT(median, 0.6);
  EXPECT_LT(p95, 2.0);
}

// So fine a mesh has pits in the nostrils, below whose walls tissue would pass through itself.
TEST(TissueRefinement, PitsThatAreTooNarrowForTissueAreFlattened) {
  Case patient = builtin_patient();
  part_lips(patient);
  const auto model = build_tissue(patient, {.surface_nodes = 2200});
  const auto& notes = summary(*model).notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("is flat where the skin folds") != std::string::npos;
  }));
  EXPECT_LT(summary(*model).rest_move_mm, 1e-4);
}

}  // namespace
}  // namespace condyle::test
