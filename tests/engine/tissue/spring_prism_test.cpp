#include "engine/tissue/spring_prism.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"
#include "engine/tissue/layered_mesh.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct Slab {
  std::vector<Eigen::Vector3i> triangles;
  Nodes rest;
  SpringPrismMesh mesh;
  int columns = 0, sheets = 0;
};

/// A wavy slab of n x n columns, its lowest sheet anchored.
Slab make_slab(int n, int sheets) {
  Slab slab;
  slab.sheets = sheets;
  slab.columns = n * n;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (int s = 0; s < sheets; ++s)
        slab.rest.emplace_back(8.0 * i + 0.7 * std::sin(j), 8.0 * j,
                               3 * std::sin(0.4 * i) - 4.0 * s);
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i;
      slab.triangles.emplace_back(a, a + 1, a + n + 1);
      slab.triangles.emplace_back(a, a + n + 1, a + n);
    }
  slab.mesh =
      layered_mesh(slab.triangles, sheets, slab.rest, std::vector<LayerMaterial>(sheets - 1));
  for (int c = 0; c < slab.columns; ++c) {
    slab.mesh.anchor_node.push_back(node_of(c, sheets - 1, sheets));
    slab.mesh.anchor_stiffness.push_back(1.0);
  }
  return slab;
}

MeshLoads loads_of(const Slab& slab, const Vector3d& moved) {
  MeshLoads loads;
  for (int node : slab.mesh.anchor_node) loads.anchor_target.push_back(slab.rest[node] + moved);
  return loads;
}

Nodes shaken(const Nodes& rest, double by_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-by_mm, by_mm);
  Nodes x = rest;
  for (auto& p : x) p += Vector3d(uniform(random), uniform(random), uniform(random));
  return x;
}

double volume_of_unit_prism() {
  const Nodes nodes{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  return prism_volume(nodes, {0, 1, 2, 3, 4, 5});
}

TEST(SpringPrism, VolumeOfAStraightPrismIsBaseTimesHeight) {
  EXPECT_NEAR(volume_of_unit_prism(), 0.5, 1e-15);
}

TEST(SpringPrism, VolumeDoesNotChangeUnderRigidMotionAndChangesSignInAMirror) {
  Nodes nodes = shaken({{0, 0, 5}, {9, 1, 5}, {2, 8, 6}, {0, 1, 0}, {8, 0, 1}, {1, 9, 0}}, 1, 5);
  const double volume = prism_volume(nodes, {0, 1, 2, 3, 4, 5});
  EXPECT_GT(volume, 100);
  const Eigen::AngleAxisd turn(1.1, Vector3d(1, 2, 3).normalized());
  Nodes turned = nodes, mirrored = nodes;
  for (auto& p : turned) p = turn * p + Vector3d(40, -20, 7);
  for (auto& p : mirrored) p.x() = -p.x();
  EXPECT_NEAR(prism_volume(turned, {0, 1, 2, 3, 4, 5}), volume, 1e-10);
  EXPECT_NEAR(prism_volume(mirrored, {0, 1, 2, 3, 4, 5}), -volume, 1e-10);
}

TEST(SpringPrism, VolumesOfNeighboursSumToTheWhole) {
  // Both splits of each shared side quad are averaged, so neighbours agree on it: shaking an inner
  // node changes no total volume.
  const Slab slab = make_slab(5, 3);
  const auto total = [&](const Nodes& x) {
    double sum = 0;
    for (const auto& prism : slab.mesh.prisms) sum += prism_volume(x, prism);
    return sum;
  };
  Nodes x = slab.rest;
  x[node_of(12, 1, 3)] += Vector3d(0.8, -0.5, 0.9);
  EXPECT_NEAR(total(x), total(slab.rest), 1e-9);
  EXPECT_NE(x[node_of(12, 1, 3)], slab.rest[node_of(12, 1, 3)]);
}

TEST(SpringPrism, GradientEqualsCentralDifferenceOverMagnitudes) {
  Slab slab = make_slab(4, 4);
  for (double shake : {0.01, 0.3, 1.2}) {
    MeshLoads loads = loads_of(slab, {0.5, -1, 0.3});
    loads.contacts = {ContactSpring::of_node(0, Vector3d::UnitZ(), 5, 1),  // two pressed, one free
                      ContactSpring::of_node(5, Vector3d::UnitX(), -50, 1),
                      ContactSpring::of_node(9, Vector3d(0, 0.6, 0.8), 90, 1)};
    const Nodes x = shaken(slab.rest, shake, 3);
    SpringPrismEnergy energy(slab.mesh, loads, 1);
    Nodes gradient, unused;
    ASSERT_TRUE(std::isfinite(energy.value_and_gradient(x, gradient)));
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const double h = 1e-5;
        Nodes up = x, down = x;
        up[i][k] += h;
        down[i][k] -= h;
        const double slope =
            (energy.value_and_gradient(up, unused) - energy.value_and_gradient(down, unused)) /
            (2 * h);
        EXPECT_NEAR(gradient[i][k], slope, 1e-6 + 1e-5 * std::abs(slope)) << shake << " node " << i;
        largest = std::max(largest, std::abs(slope));
      }
    EXPECT_GT(largest, 1e-3);
  }
}

TEST(SpringPrism, CurvatureEqualsDifferenceOfGradientsAlongTheDirection) {
  const Slab slab = make_slab(4, 4);
  const MeshLoads loads = loads_of(slab, {0, 0, 0.4});
  const Nodes x = shaken(slab.rest, 0.8, 7), zero(x.size(), Vector3d::Zero());
  const Nodes d = shaken(zero, 1, 8);
  SpringPrismEnergy energy(slab.mesh, loads, 1);
  const double h = 1e-5;
  Nodes up = x, down = x, g_up, g_down, g;
  for (std::size_t i = 0; i < x.size(); ++i) {
    up[i] += h * d[i];
    down[i] -= h * d[i];
  }
  energy.value_and_gradient(up, g_up);
  energy.value_and_gradient(down, g_down);
  energy.value_and_gradient(x, g);
  double expected = 0;
  for (std::size_t i = 0; i < x.size(); ++i) expected += d[i].dot(g_up[i] - g_down[i]) / (2 * h);
  EXPECT_GT(std::abs(expected), 1e-2);
  EXPECT_NEAR(energy.curvature(x, d).exact, expected, 1e-4 * std::abs(expected));
}

TEST(SpringPrism, EnergyDoesNotChangeUnderRigidMotion) {
  const Slab slab = make_slab(4, 3);
  MeshLoads loads = loads_of(slab, {1, 2, 0});
  Nodes x = shaken(slab.rest, 0.7, 11), gradient;
  const double before = SpringPrismEnergy(slab.mesh, loads, 1).value_and_gradient(x, gradient);
  const Eigen::AngleAxisd turn(2.1, Vector3d(3, -1, 2).normalized());
  for (auto& p : x) p = turn * p + Vector3d(100, 3, -50);
  for (auto& p : loads.anchor_target) p = turn * p + Vector3d(100, 3, -50);
  const double after = SpringPrismEnergy(slab.mesh, loads, 1).value_and_gradient(x, gradient);
  EXPECT_GT(before, 0.1);
  EXPECT_NEAR(after, before, 1e-10 * before);
}

TEST(Minimizer, FollowsARigidMotionOfItsAnchorsExactly) {
  const Slab slab = make_slab(6, 4);
  const HessianFactor factor(slab.mesh, loads_of(slab, Vector3d::Zero()), slab.sheets, slab.rest);
  Nodes x = slab.rest;
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-8;
  const MeshLoads loads = loads_of(slab, {0, 1.5, 0.5});
  SpringPrismEnergy energy(slab.mesh, loads, 1);
  const auto result = minimize(energy, factor, settings, x);
  EXPECT_TRUE(result.converged());
  EXPECT_GT(result.iterations, 0);
  EXPECT_LT(result.energy, 1e-12);
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_LT((x[i] - slab.rest[i] - Vector3d(0, 1.5, 0.5)).norm(), 1e-5);
}

TEST(HessianFactor, ExactCurvaturesUndoADifferenceOfGradients) {
  Slab slab = make_slab(7, 4);
  for (auto& length : slab.mesh.rest_length) length *= 0.95;
  const MeshLoads loads = loads_of(slab, {0, 0.4, 0.3});
  const Nodes x = shaken(slab.rest, 0.08, 3);
  HessianFactor factor(slab.mesh, loads, slab.sheets, slab.rest);
  ASSERT_EQ(factor.refactor(slab.mesh, loads, x, 1, HessianKind::exact), 0);
  HessianFactor gauss_newton = factor;
  gauss_newton.refactor(slab.mesh, loads, x);

  SpringPrismEnergy energy(slab.mesh, loads, 1);
  Nodes up = x, down = x, d = x, g, g_down, z, z_gauss_newton;
  constexpr double h = 1e-5;
  for (std::size_t i = 0; i < x.size(); ++i) {
    d[i] = Vector3d(std::sin(0.05 * x[i].y()), 0.2 * std::cos(0.1 * x[i].x()), 0.3);
    up[i] += h * d[i];
    down[i] -= h * d[i];
  }
  energy.value_and_gradient(up, g);
  energy.value_and_gradient(down, g_down);
  for (std::size_t i = 0; i < x.size(); ++i) g[i] = (g[i] - g_down[i]) / (2 * h);
  factor.solve(g, z);
  gauss_newton.solve(g, z_gauss_newton);
  double error = 0, without = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    error = std::max(error, (z[i] - d[i]).norm());
    without = std::max(without, (z_gauss_newton[i] - d[i]).norm());
  }
  // it is stored in eight bits, and only it contains what holds loose nodes
  EXPECT_LT(error, 0.01);
  EXPECT_GT(without, 2 * error);
}

TEST(Minimizer, NeverInvertsAPrismHoweverHardItIsPressed) {
  Slab slab = make_slab(6, 3);
  MeshLoads loads = loads_of(slab, Vector3d::Zero());
  for (int c = 0; c < slab.columns; ++c) {  // the skin is pulled to 12 mm below the bone
    slab.mesh.anchor_node.push_back(node_of(c, 0, 3));
    slab.mesh.anchor_stiffness.push_back(0.02);
    loads.anchor_target.push_back(slab.rest[node_of(c, 0, 3)] - Vector3d(0, 0, 20));
  }
  const HessianFactor factor(slab.mesh, loads, 3, slab.rest);
  Nodes x = slab.rest;
  SpringPrismEnergy energy(slab.mesh, loads, 1);
  minimize(energy, factor, {}, x);
  double least = 1e9;
  for (std::size_t p = 0; p < slab.mesh.prisms.size(); ++p)
    least = std::min(least, prism_volume(x, slab.mesh.prisms[p]) / slab.mesh.rest_volume[p]);
  EXPECT_GT(least, 0);
  EXPECT_LT(least, 0.8);  // it was pressed indeed
}

TEST(Minimizer, IsBitIdenticalForAnyNumberOfThreads) {
  const Slab slab = make_slab(8, 4);
  const HessianFactor factor(slab.mesh, loads_of(slab, Vector3d::Zero()), slab.sheets, slab.rest);
  const MeshLoads loads = loads_of(slab, {0, 0, 0});
  Nodes one = shaken(slab.rest, 0.9, 21), two = one;
  MinimizeSettings settings;
  SpringPrismEnergy energy(slab.mesh, loads, 1), energy_on_two(slab.mesh, loads, 2);
  const auto a = minimize(energy, factor, settings, one);
  const auto b = minimize(energy_on_two, factor, settings, two);
  EXPECT_GT(a.iterations, 1);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.energy, b.energy);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i], two[i]);
}

}  // namespace
}  // namespace condyle
