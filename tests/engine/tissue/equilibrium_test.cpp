#include "engine/tissue/equilibrium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/core/error.h"
#include "engine/tissue/hessian_factor.h"
#include "tools/bench/baseline/baseline_minimizers.h"
#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

double farthest(const Nodes& a, const Nodes& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

struct Prestressed {
  SyntheticSet set;
  MeshLoads loads;
  Equilibrium equilibrium;
};

/// A tissue of 130 g with taut skin, balanced. The layers' masses differ.
Prestressed prestressed(int layers, double c_turgor, const Vector3d& down,
                        const EquilibriumSettings& settings = {}) {
  Prestressed p{make_synthetic_set({150, 46, layers, 52, {0, layers}}), {}, {}};
  set_turgor(p.set.mesh, c_turgor);
  for (std::size_t i = 0; i < p.set.mesh.node_mass_kg.size(); ++i)
    p.set.mesh.node_mass_kg[i] = 0.13 / p.set.mesh.node_count;
  p.loads = synthetic_loads(p.set, Pose{});
  p.loads.node_force = weight_of_nodes(p.set.mesh, down);
  p.equilibrium = balance_strains(p.set.mesh, p.loads, p.set.rest, settings);
  p.set.anchor_offset = p.equilibrium.anchor_offset;
  Nodes force = p.loads.node_force;
  for (std::size_t i = 0; i < p.equilibrium.held.size(); ++i) force[i] += p.equilibrium.held[i];
  p.loads = synthetic_loads(p.set, Pose{});
  p.loads.node_force = force;
  return p;
}

class EachLayerCount : public testing::TestWithParam<int> {};

TEST_P(EachLayerCount, NothingMovesBeforeSurgeryUnderPretensionAndGravityInAnyDirection) {
  for (const Vector3d& down : {Vector3d(0, 0, -1), Vector3d(0, 1, 0), Vector3d(0.6, 0, -0.8)})
    for (double c_turgor : {0.95, 0.5, 0.05}) {
      const Prestressed p = prestressed(GetParam(), c_turgor, down);
      EXPECT_GT(p.equilibrium.force_before, 1e-3);
      EXPECT_LT(p.equilibrium.force_after, 1e-10);
      EXPECT_GT(p.equilibrium.max_strain, 1e-3);
      EXPECT_LE(p.equilibrium.max_strain, 0.9);
      EXPECT_LT(p.equilibrium.max_volume_strain, 0.5);
      EXPECT_TRUE(p.equilibrium.stable);
      EXPECT_EQ(p.equilibrium.held.empty(), p.equilibrium.force_held == 0);
      EXPECT_GT(p.equilibrium.rest_energy, 0);
      SpringPrismEnergy energy(p.set.mesh, p.loads, 1);
      const HessianFactor factor(p.set.mesh, p.loads, p.set.sheets, p.set.rest);
      for (Method method : {Method::preconditioned, Method::cg_parabolic}) {
        Nodes x = p.set.rest;
        MinimizeSettings settings;
        settings.tolerance_mm = 1e-6;
        const auto result = minimize_with(method, energy, settings, x, &factor);
        EXPECT_LT(farthest(x, p.set.rest), 1e-4);
        EXPECT_NEAR(result.energy, p.equilibrium.rest_energy, 1e-9 * p.equilibrium.rest_energy);
      }
    }
}

TEST_P(EachLayerCount, ShakenTissueComesBackToTheBalancedState) {
  const Prestressed p = prestressed(GetParam(), 0.9, Vector3d::Zero());
  SpringPrismEnergy energy(p.set.mesh, p.loads, 1);
  const HessianFactor factor(p.set.mesh, p.loads, p.set.sheets, p.set.rest);
  Nodes x = p.set.rest;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  for (auto& v : x) v += Vector3d(uniform(random), uniform(random), uniform(random));
  EXPECT_GT(farthest(x, p.set.rest), 0.2);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-6;
  EXPECT_TRUE(minimize(energy, factor, settings, x).converged());
  EXPECT_LT(farthest(x, p.set.rest), 1e-4);
}

TEST_P(EachLayerCount, UnbalancedStrainsAreHeldAndReported) {
  const EquilibriumSettings hardly{.max_pull = 0.004, .max_push = 0.004, .max_volume = 0.002};
  const Prestressed p = prestressed(GetParam(), 0.8, Vector3d(0, 0, -1), hardly);
  EXPECT_LE(p.equilibrium.max_strain, 0.004 + 1e-12);
  EXPECT_GT(p.equilibrium.at_bound, 10);
  EXPECT_GT(p.equilibrium.force_held, 1e-4);
  EXPECT_LT(p.equilibrium.force_held, 2 * p.equilibrium.force_before);
  EXPECT_GT(p.equilibrium.nodes_held, 0);
  EXPECT_LT(p.equilibrium.force_after, 1e-10);
  double most = 0;
  for (const auto& f : p.equilibrium.held) most = std::max(most, f.norm());
  EXPECT_NEAR(most, p.equilibrium.force_held, 1e-12);
  SpringPrismEnergy energy(p.set.mesh, p.loads, 1);
  const HessianFactor factor(p.set.mesh, p.loads, p.set.sheets, p.set.rest);
  Nodes x = p.set.rest;
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-6;
  EXPECT_TRUE(minimize(energy, factor, settings, x).converged());
  EXPECT_LT(farthest(x, p.set.rest), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Equilibrium, EachLayerCount, testing::Values(1, 2, 3, 5));

TEST(Equilibrium, WithoutBalancingTautSkinMoves) {
  SyntheticSet set = make_synthetic_set({150, 46, 3, 52, {0, 3}});
  const HessianFactor factor(set.mesh, synthetic_loads(set, Pose{}), set.sheets, set.rest);
  set_turgor(set.mesh, 0.9);
  const MeshLoads loads = synthetic_loads(set, Pose{});
  SpringPrismEnergy energy(set.mesh, loads, 1);
  Nodes x = set.rest;
  minimize(energy, factor, {}, x);
  EXPECT_GT(farthest(x, set.rest), 0.05);
}

TEST(Equilibrium, WeightIsThatOfTheLayersMasses) {
  std::vector<LayerMaterial> layers(3);
  layers[0].mass_kg = 0.05;
  layers[1].mass_kg = 0.02;
  layers[2].mass_kg = 0.06;
  const SyntheticSet set = make_synthetic_set({60, 20, 3, 10, {0, 3}});
  const SpringPrismMesh mesh = layered_mesh(set.triangles, set.sheets, set.rest, layers);
  Vector3d sum = Vector3d::Zero();
  double outermost = 0;
  for (const auto& force : weight_of_nodes(mesh, Vector3d(0, 0, -1))) sum += force;
  for (int c = 0; c < set.columns; ++c) outermost += mesh.node_mass_kg[node_of(c, 0, set.sheets)];
  EXPECT_NEAR(sum.z(), -9.81 * 0.13, 1e-12);
  EXPECT_NEAR(outermost, 0.025, 1e-12);
}

TEST(Equilibrium, ValuesOutOfRangeAreRefusedWithTheValue) {
  SyntheticSet set = make_synthetic_set({60, 20, 2, 10, {0, 2}});
  const double nan = std::nan("");
  for (double c : {0.0, -0.5, 1.01, nan}) EXPECT_THROW(set_turgor(set.mesh, c), InputError) << c;
  for (double lambda : {0.0, 1.0, -1.0, nan})
    EXPECT_THROW(use_paper_form(set.mesh, {{1, 1}, lambda}), InputError) << lambda;
  for (double k : {0.0, -1.0, nan})
    EXPECT_THROW(use_paper_form(set.mesh, {{1, k}, 0.9}), InputError) << k;
  for (double modulus : {0.0, -0.1, nan}) {
    std::vector<LayerMaterial> layers(2);
    layers[1].modulus_MPa = modulus;
    EXPECT_THROW(layered_mesh(set.triangles, set.sheets, set.rest, layers), InputError);
  }
}

}  // namespace
}  // namespace condyle
