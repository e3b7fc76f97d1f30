#include "sim/tissue/tissue.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "sim/case/case_io.h"
#include "sim/tissue/lips.h"
#include "tests/sim/tissue/plain_patient.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::opening;
using test::plain_patient;

double opening_of_pose(const Case& patient, const Pose& X_CM) {
  const Vector3d incisor = *patient.landmarks.find("lower_incisal_point");
  return incisor.z() - (X_CM * incisor).z();
}

TEST(Tissue, NoFaceNoTissue) {
  Case patient = plain_patient();
  patient.parts.pop_back();
  EXPECT_EQ(build_tissue(patient), nullptr);
}

TEST(Tissue, IsBitIdenticalForAnyNumberOfBuildingThreads) {
  Case patient = plain_patient();
  part_lips(patient);
  const auto one = build_tissue(patient, {.threads = 1}),
             two = build_tissue(patient, {.threads = 2});
  const Pose X_CM = opening(patient, 12);
  const TissueState first = solve_tissue(*one, rest_tissue(*one), test::jaw_at(X_CM));
  const TissueState second = solve_tissue(*two, rest_tissue(*two), test::jaw_at(X_CM));
  EXPECT_GT(first.iterations, 0);
  EXPECT_EQ(first.iterations, second.iterations);
  EXPECT_EQ(first.nodes, second.nodes);
}

TEST(Tissue, RestIsAnEquilibriumAndReproducesTheFace) {
  Case patient = plain_patient();
  part_lips(patient);
  const auto model = build_tissue(patient);
  ASSERT_TRUE(model);
  const TissueState rest = rest_tissue(*model);
  const TissueState still = solve_tissue(*model, rest, {});
  EXPECT_TRUE(still.converged);
  EXPECT_EQ(still.inverted_prisms, 0);
  EXPECT_LT(still.residual, 1e-9);
  for (std::size_t i = 0; i < rest.nodes.size(); ++i)
    EXPECT_LT((still.nodes[i] - rest.nodes[i]).norm(), 1e-4);
  std::vector<Vector3f> face;
  deform_face(*model, rest, face);
  const auto& vertices = patient.find(Role::face)->mesh.vertices;
  ASSERT_EQ(face.size(), vertices.size());
  for (std::size_t v = 0; v < face.size(); ++v) EXPECT_EQ(face[v], vertices[v].cast<float>());
}

TEST(Tissue, ClosedLipsAreCutOnceAndPart) {
  Case patient = plain_patient();
  const std::size_t before = patient.find(Role::face)->mesh.vertices.size();
  part_lips(patient);
  const std::size_t cut = patient.find(Role::face)->mesh.vertices.size();
  EXPECT_GT(cut, before + 10);
  part_lips(patient);
  EXPECT_EQ(patient.find(Role::face)->mesh.vertices.size(), cut);

  const auto model = build_tissue(patient);
  ASSERT_TRUE(summary(*model).lips_cut);
  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  for (int degrees = 1; degrees <= 20; ++degrees) {
    state = solve_tissue(*model, state, test::jaw_at(opening(patient, degrees)), {}, warm);
    EXPECT_EQ(state.inverted_prisms, 0) << degrees;
    EXPECT_TRUE(state.converged) << degrees;
  }
  const Vector3d upper(0, -102, -47), lower(0, -102, -54);
  const double gap =
      carried_point(*model, state, upper).z() - carried_point(*model, state, lower).z() - 7;
  EXPECT_GT(gap, 0.7 * opening_of_pose(patient, opening(patient, 20)));
}

TEST(Tissue, IsBitIdenticalForOneAndTwoThreads) {
  Case patient = plain_patient();
  part_lips(patient);
  const auto model = build_tissue(patient, {.surface_nodes = 260});
  const Pose X_CM = opening(patient, 6);
  const TissueState one = solve_tissue(*model, rest_tissue(*model), test::jaw_at(X_CM));
  TissueBudget budget;
  budget.threads = 2;
  const TissueState two = solve_tissue(*model, rest_tissue(*model), test::jaw_at(X_CM), budget);
  EXPECT_GT(one.iterations, 0);
  EXPECT_EQ(one.nodes, two.nodes);
  std::vector<Vector3f> face_one, face_two;
  deform_face(*model, one, face_one, 1);
  deform_face(*model, one, face_two, 2);
  EXPECT_EQ(face_one, face_two);
}

TEST(Tissue, TenSmallStepsEqualOneLarge) {
  Case patient = plain_patient();
  part_lips(patient);
  const auto model = build_tissue(patient, {.surface_nodes = 260});
  const auto moved = [](double mm) {
    Pose X_CM;
    X_CM.t = Vector3d(0, 0.6, -0.8) * mm;
    return X_CM;
  };
  TissueBudget tight;  // differences are below the tolerance of the stop test
  tight.tolerance_mm = 1e-3;
  TissueState small = rest_tissue(*model);
  TissueWarmStart warm;
  for (int i = 1; i <= 10; ++i)
    small = solve_tissue(*model, small, test::jaw_at(moved(0.1 * i)), tight, warm);
  const TissueState large =
      solve_tissue(*model, rest_tissue(*model), test::jaw_at(moved(1.0)), tight);
  double moved_most = 0;
  for (std::size_t i = 0; i < small.nodes.size(); ++i) {
    const double difference = (small.nodes[i] - large.nodes[i]).norm();
    EXPECT_LT(difference, 0.01) << i;
    moved_most = std::max(moved_most, (large.nodes[i] - rest_tissue(*model).nodes[i]).norm());
  }
  EXPECT_GT(moved_most, 0.9);
}

TEST(Tissue, LayersOtherThanThreeWorkToo) {
  Case patient = plain_patient();
  part_lips(patient);
  for (int layers : {1, 2, 5}) {
    const auto model =
        build_tissue(patient, {.surface_nodes = 200, .plan = {.layer_count = layers}});
    EXPECT_EQ(summary(*model).nodes % (layers + 1), 0);
    const TissueState state =
        solve_tissue(*model, rest_tissue(*model), test::jaw_at(opening(patient, 5)));
    EXPECT_EQ(state.inverted_prisms, 0);
    EXPECT_TRUE(state.converged);
  }
}

// What a surgeon expects of an opened mouth, on a real patient.
TEST(Tissue, TheBadinFaceOpensItsMouth) {
  const auto folder = test::source_folder() / "../shared/data/case-badin";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  ImportRequest request;
  request.files = {{Role::maxilla, folder / "maxilla_capped.ply"},
                   {Role::mandible, folder / "mandible.ply"},
                   {Role::face, folder / "face_skin.ply"}};
  request.landmarks = folder / "markers.csv";
  const Case patient = import_meshes(request);
  const auto model = build_tissue(patient);
  ASSERT_TRUE(model && summary(*model).lips_cut);
  EXPECT_NEAR(summary(*model).nodes, 2080, 200);

  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  Pose X_CM;
  int iterations = 0;
  constexpr int frames = 90;
  for (int i = 1; i <= frames; ++i) {
    X_CM = opening(patient, 19 * (1 - std::cos(std::numbers::pi * i / frames)));
    state = solve_tissue(*model, state, test::jaw_at(X_CM), {}, warm);
    iterations += state.iterations;
    EXPECT_EQ(state.inverted_prisms, 0) << i;
    EXPECT_TRUE(state.converged) << i;
  }
  const double drop = opening_of_pose(patient, X_CM);
  EXPECT_GT(drop, 40);

  const auto moved = [&](const char* name) {
    const Vector3d p = *patient.landmarks.find(name);
    return Vector3d(carried_point(*model, state, p) - p);
  };
  const Vector3d chin = *patient.landmarks.find("pogonion");
  const Vector3d bone = X_CM * chin - chin;
  EXPECT_GT(moved("soft_pogonion").dot(bone) / bone.squaredNorm(), 0.9);
  EXPECT_LT(moved("pronasale").norm(), 0.5);
  EXPECT_GT(moved("labrale_superius").z() - moved("labrale_inferius").z(), 0.7 * drop);

  const TissueState cold = solve_tissue(*model, rest_tissue(*model), test::jaw_at(X_CM));
  const double ratio = static_cast<double>(iterations) / frames / cold.iterations;
  std::printf("iterations: warm %.1f a frame, cold %d, ratio %.3f\n",
              static_cast<double>(iterations) / frames, cold.iterations, ratio);
  EXPECT_LT(ratio, 1);
}

}  // namespace
}  // namespace condyle
