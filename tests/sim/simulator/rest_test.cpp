// Nothing moves before surgery: on every patient, whatever the layers, the skin's tension and where
// weight pulls.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "sim/phantom/phantom.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "sim/tissue/tissue.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/scan_case.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

struct AtRest {
  int layers;
  double turgor;
  Vector3d down;  // zero: no weight
};

const Vector3d upright(0, 0, -1), lying(0, 1, 0), oblique(0.5, 0.6, -0.6), none(0, 0, 0);

bool reported(const TissueSummary& summary, const char* words) {
  for (const auto& note : summary.notes)
    if (note.find(words) != std::string::npos) return true;
  return false;
}

void expect_still(Case patient, const std::vector<AtRest>& rows, int surface_nodes) {
  part_lips(patient);
  for (const auto& [layers, turgor, down] : rows) {
    SCOPED_TRACE(testing::Message() << layers << " layers, turgor " << turgor << ", weight along "
                                    << down.transpose());
    TissuePlan plan{.layer_count = layers, .turgor = turgor};
    if (down.norm() > 0) plan.down = down;
    const auto model = build_tissue(patient, {.surface_nodes = surface_nodes, .plan = plan});
    const TissueSummary& made = summary(*model);
    EXPECT_LT(made.rest_move_mm, 1e-4);
    EXPECT_LT(made.rest_force_N, 1e-8);
    EXPECT_TRUE(turgor < 0.8 ||
                !reported(made, "constant forces of up to"));  // strains do it alone
    EXPECT_FALSE(reported(made, "is unstable at rest"));

    // Not only is it at rest, it returns to rest.
    TissueBudget budget;
    budget.tolerance_mm = 1e-4;
    budget.max_iterations = 100;
    const TissueState rest = rest_tissue(*model);
    TissueState shaken = rest;
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-0.01, 0.01);
    for (auto& p : shaken.nodes) p += Vector3d(uniform(random), uniform(random), uniform(random));
    const TissueState back = solve_tissue(*model, shaken, {}, budget);
    EXPECT_FALSE(back.reused);
    double most = 0;
    for (std::size_t i = 0; i < rest.nodes.size(); ++i)
      most = std::max(most, (back.nodes[i] - rest.nodes[i]).norm());
    EXPECT_LT(most, 0.005);  // slivers at the lips' edges converge last
  }
}

TEST(NothingMovesBeforeSurgery, OnTheBuiltInPatient) {
  expect_still(builtin_patient(),
               {{1, 0.9, upright}, {2, 0.6, oblique}, {3, 0.3, lying}, {5, 0.6, none}}, 220);
}

TEST(NothingMovesBeforeSurgery, OnARealFace) {
  const auto patient = case_badin_with_face();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_still(*patient, {{1, 0.9, oblique}}, 520);
  expect_still(*patient, {{1, 0.05, none}, {2, 0.3, upright}, {3, 0.6, lying}, {5, 0.9, oblique}},
               220);
}

TEST(NothingMovesBeforeSurgery, ForcesThatStrainsCannotBalanceTurnWithTheJaw) {
  TissuePlan plan{.turgor = 0.1};
  plan.layers = {{.fraction = 1.0}};
  const auto model = build_tissue(builtin_patient(), {.plan = plan});
  ASSERT_FALSE(model->support.held_force.empty());
  Pose X_CM;
  X_CM.R = Eigen::AngleAxisd(0.4, Vector3d::UnitX());
  X_CM.t = Vector3d(0, -8, -4);
  const MeshLoads at_rest = loads_at(*model, {}), opened = loads_at(*model, jaw_at(X_CM));
  int with_jaw = 0, with_skull = 0;
  for (std::size_t i = 0; i < model->mesh->rest.size(); ++i) {
    const Vector3d& held = at_rest.node_force[i];
    if (held.norm() < 1e-3) continue;
    const double fraction = model->support.node.sum(i);
    const Vector3d expected = fraction > 0.5 ? X_CM.R * held : held;
    // largest displacement by the rotation
    const double most = 2 * std::sin(rotation_angle(X_CM) / 2) * held.norm();
    EXPECT_LE((opened.node_force[i] - expected).norm(),
              std::min(fraction, 1 - fraction) * most + 1e-9);
    (fraction > 0.5 ? with_jaw : with_skull) += 1;
  }
  EXPECT_GT(with_jaw, 0);
  EXPECT_GT(with_skull, 0);
}

TEST(NothingMovesBeforeSurgery, OnAScanOverScaledBones) {
  const auto patient = scan_over_scaled_bones();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_still(*patient, {{1, 0.3, oblique}, {2, 0.9, none}, {3, 0.1, upright}, {5, 0.6, lying}},
               220);
}

}  // namespace
}  // namespace condyle::test
