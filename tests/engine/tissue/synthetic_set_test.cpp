#include "tools/bench/baseline/synthetic_set.h"

#include <gtest/gtest.h>

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

void expect_size(const SyntheticSize& size, int positions, int springs, int volumes) {
  const SyntheticSet set = make_synthetic_set(size);
  EXPECT_EQ(set.mesh.node_count, positions);
  EXPECT_EQ(set.springs(), springs);
  EXPECT_EQ(set.mesh.prisms.size(), static_cast<std::size_t>(volumes));
  for (double volume : set.mesh.rest_volume) EXPECT_GT(volume, 0);
}

TEST(SyntheticSet, HasThePublishedCounts) {
  expect_size(table1_size(), 138, 986, 144);
  expect_size(patient2_size(), 2092, 16547, 2820);
  expect_size(patient1_size(), 753, 5688, 874);
}

TEST(SyntheticSet, ComesInAnySizeAndNumberOfLayers) {
  for (int layers : {1, 2, 3, 5}) {
    const SyntheticSet set = make_synthetic_set({80, 26, layers, 30, {0, layers}});
    EXPECT_EQ(set.mesh.node_count, 80 * (layers + 1));
    for (double volume : set.mesh.rest_volume) EXPECT_GT(volume, 0);
  }
  const int nodes = make_synthetic_set(size_of_nodes(10000)).mesh.node_count;
  EXPECT_NEAR(nodes, 10000, 300);
}

TEST(SyntheticSet, BonesCarryTheirTissueAndNothingIsStretchedAtRest) {
  const SyntheticSet set = make_synthetic_set(table1_size());
  const MeshLoads rest = synthetic_loads(set, Pose{});
  Nodes gradient, x = set.rest;
  EXPECT_LT(SpringPrismEnergy(set.mesh, rest, 1).value_and_gradient(x, gradient), 1e-20);
  const HessianFactor factor(set.mesh, rest, set.sheets, set.rest);
  const Pose pose = synthetic_pose(0, {0, -4, 0});
  const MeshLoads loads = synthetic_loads(set, pose);
  SpringPrismEnergy energy(set.mesh, loads, 1);
  EXPECT_TRUE(minimize(energy, factor, {}, x).converged());
  int moving = 0, still = 0;
  for (std::size_t i = 0; i < set.anchor_moves.size(); ++i) {
    const double moved = set.rest[set.mesh.anchor_node[i]].y() - x[set.mesh.anchor_node[i]].y();
    EXPECT_NEAR(moved, set.anchor_moves[i] ? 4 : 0, 1.0);
    ++(set.anchor_moves[i] ? moving : still);
  }
  EXPECT_GT(moving, 5);
  EXPECT_GT(still, 50);
}

/// The published test of robustness: the same movement in ten steps, at a small and a wide opening.
TEST(SyntheticSet, TenSmallMovesEqualOneLargeMove) {
  const SyntheticSet set = make_synthetic_set(table1_size());
  const HessianFactor factor(set.mesh, synthetic_loads(set, Pose{}), set.sheets, set.rest);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-6;
  for (double opening : {0.03, 0.5}) {
    Nodes open = set.rest;
    const auto solve = [&](const Vector3d& moved, Nodes& x) {
      const MeshLoads loads = synthetic_loads(set, synthetic_pose(opening, moved));
      SpringPrismEnergy energy(set.mesh, loads, 1);
      EXPECT_TRUE(minimize(energy, factor, settings, x).converged());
    };
    solve(Vector3d::Zero(), open);
    Nodes once = open, stepwise = open;
    solve({0, -1, 0}, once);
    for (int i = 1; i <= 10; ++i) solve({0, -0.1 * i, 0}, stepwise);
    double most = 0, moved = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
      most = std::max(most, (once[i] - stepwise[i]).norm());
      moved = std::max(moved, (once[i] - open[i]).norm());
    }
    EXPECT_GT(moved, 0.8);
    EXPECT_LT(most, 0.01) << opening;
  }
}

}  // namespace
}  // namespace condyle
