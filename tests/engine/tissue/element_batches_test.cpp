#include "engine/tissue/element_batches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tools/bench/baseline/plain_elements.h"
#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {
namespace {

template <class T>
void reorder(std::vector<T>& values, const std::vector<int>& order) {
  std::vector<T> taken;
  for (int i : order) taken.push_back(values[i]);
  values = std::move(taken);
}

std::vector<int> shuffled(std::size_t count, std::mt19937& random) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

/// A bent slab of `layers`.
SyntheticSet set_of(int layers) {
  SyntheticSize size = table1_size();
  size.layers = layers;
  size.boundary_sheets = {0};
  return make_synthetic_set(size);
}

TEST(ElementBatches, GroupALayeredMeshByColumns) {
  for (const int layers : {1, 2, 3, 5}) {
    const SyntheticSet set = set_of(layers);
    const ElementBatches batches(set.mesh);
    const std::size_t parts = layers > 3 ? 2 : 1, columns = set.columns,
                      edges = edges_of(set.triangles).size();
    EXPECT_EQ(batches.edges.size(), (edges * parts + 3) / 4 * 4) << layers;
    EXPECT_EQ(batches.vertical_edges.size(), (columns * parts + 3) / 4 * 4) << layers;
    EXPECT_EQ(batches.prism_columns.size(), (set.triangles.size() * parts + 3) / 4 * 4) << layers;
    EXPECT_TRUE(batches.spring_batches.empty()) << layers;
    EXPECT_TRUE(batches.prisms.empty()) << layers;
    const auto given = std::accumulate(set.mesh.stiffness.begin(), set.mesh.stiffness.end(), 0.0);
    EXPECT_NEAR(std::accumulate(batches.stiffness.begin(), batches.stiffness.end(), 0.0), given,
                1e-12 * given);
  }
}

/// The same with springs over several layers.
SyntheticSet shear_set_of(int layers) {
  SyntheticSet set = set_of(layers);
  set.mesh = layered_mesh(set.triangles, set.sheets, set.rest, default_layers(layers).material,
                          ShearSprings::over_layers);
  return set;
}

TEST(ElementBatches, SpringsOverThreeLayersFillTheFreeLanesOfTheirEdge) {
  for (const int layers : {2, 3, 5}) {
    const SyntheticSet set = shear_set_of(layers);
    EXPECT_GT(set.mesh.spring_a.size(), set_of(layers).mesh.spring_a.size());
    const ElementBatches batches(set.mesh), without(set_of(layers).mesh);
    EXPECT_EQ(batches.edges.size(), without.edges.size());
    EXPECT_EQ(batches.spring_batches.empty(), layers == 3);
    const auto given = std::accumulate(set.mesh.stiffness.begin(), set.mesh.stiffness.end(), 0.0);
    EXPECT_NEAR(std::accumulate(batches.stiffness.begin(), batches.stiffness.end(), 0.0), given,
                1e-12 * given);
  }
}

/// Results of one instruction set for a mesh.
struct KernelResult {
  std::vector<double> gradient, inverse_length;
  std::vector<double> sums;
};
KernelResult result_of(const ElementKernels& kernels, const ElementBatches& batches,
                       std::vector<double> x, std::vector<double> d) {
  const std::size_t row = x.size() / 3;
  const auto rows = [row](std::vector<double>& of) {
    return AxisRows{of.data(), of.data() + row, of.data() + 2 * row};
  };
  KernelResult result;
  result.gradient.resize(x.size());
  result.inverse_length.resize(batches.rest_length.size());
  for (int half = 0; half < 2; ++half) {
    result.sums.push_back(kernels.springs(batches, half, 0.1, rows(x), rows(result.gradient),
                                          result.inverse_length.data()));
    result.sums.push_back(
        kernels.prisms(batches, half, 0.3, 0.5, rows(x), 0.7, rows(result.gradient)));
    const auto springs =
        kernels.springs_bend(batches, half, 0.1, rows(x), rows(d), result.inverse_length.data());
    const auto prisms = kernels.prisms_bend(batches, half, 0.3, 0.5, rows(x), rows(d));
    result.sums.insert(result.sums.end(),
                       {springs.exact, springs.gauss_newton, prisms.exact, prisms.gauss_newton});
  }
  return result;
}

TEST(ElementBatches, AllInstructionSetsAgree) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> entry(-0.3, 0.3);
  for (const int layers : {1, 2, 3, 5}) {
    SyntheticSet set = set_of(layers);
    // Includes isolated springs, many at a few nodes.
    for (int k = 0; k < 60; ++k) {
      set.mesh.spring_a.push_back(k % 7);
      set.mesh.spring_b.push_back(9 + (5 * k) % 8);
      set.mesh.rest_length.push_back(3);
      set.mesh.stiffness.push_back(0.5);
    }
    const ElementBatches batches(set.mesh);
    EXPECT_FALSE(batches.spring_batches.empty());
    const std::size_t row = set.rest.size() + ElementBatches::lanes;
    std::vector<double> x(3 * row), d(3 * row);
    for (std::size_t i = 0; i < set.rest.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        x[k * row + i] = set.rest[i][static_cast<Eigen::Index>(k)] + entry(random);
        d[k * row + i] = entry(random);
      }
    const KernelResult best = result_of(element_kernels(), batches, x, d);
    for (double sum : best.sums) ASSERT_TRUE(std::isfinite(sum));
    for (const ElementKernels* kernels : usable_element_kernels()) {
      const KernelResult result = result_of(*kernels, batches, x, d);
      const bool fused = kernels != usable_element_kernels().back();
      const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b) {
        double largest = 0;
        for (double v : b) largest = std::max(largest, std::abs(v));
        for (std::size_t i = 0; i < a.size(); ++i)
          if (fused)
            EXPECT_EQ(a[i], b[i]) << layers << " " << i;
          else
            EXPECT_NEAR(a[i], b[i], 1e-12 * largest) << layers << " " << i;
      };
      compare(result.gradient, best.gradient);
      compare(result.inverse_length, best.inverse_length);
      compare(result.sums, best.sums);
    }
  }
}

// What the benchmark compares the batches with has their values.
void expect_plain_loops_agree(const SyntheticSet& set) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> entry(-0.3, 0.3);
  const ElementBatches batches(set.mesh);
  const std::size_t row = set.rest.size() + ElementBatches::lanes;
  std::vector<double> x(3 * row), own(3 * row), plain(3 * row), inverse(batches.rest_length.size());
  for (std::size_t i = 0; i < set.rest.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[k * row + i] = set.rest[i][static_cast<Eigen::Index>(k)] + entry(random);
  const auto rows = [row](std::vector<double>& of) {
    return AxisRows{of.data(), of.data() + row, of.data() + 2 * row};
  };
  constexpr double scale = 0.7;
  double energy = 0;
  for (const int half : {0, 1})
    energy += element_kernels().springs(batches, half, set.mesh.compression_ratio, rows(x),
                                        rows(own), inverse.data()) +
              scale * element_kernels().prisms(batches, half, set.mesh.barrier_fraction,
                                               set.mesh.barrier_weight, rows(x), scale, rows(own));
  EXPECT_GT(energy, 0.1);
  EXPECT_NEAR(PlainElements(set.mesh).value_and_gradient(rows(x), scale, rows(plain)), energy,
              1e-11 * energy);
  double largest = 0;
  for (const double v : own) largest = std::max(largest, std::abs(v));
  for (std::size_t i = 0; i < own.size(); ++i) ASSERT_NEAR(own[i], plain[i], 1e-11 * largest) << i;

  // A collapsed prism.
  const auto& corners = set.mesh.prisms.front();
  for (int k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      x[axis * row + static_cast<std::size_t>(corners[k + 3])] =
          x[axis * row + static_cast<std::size_t>(corners[k])];
  EXPECT_TRUE(std::isinf(PlainElements(set.mesh).value_and_gradient(rows(x), scale, rows(plain))));
}

TEST(ElementBatches, PlainLoopsGiveTheSameEnergyAndGradient) {
  expect_plain_loops_agree(set_of(3));
  for (const int layers : {2, 3, 5}) expect_plain_loops_agree(shear_set_of(layers));
}

class AnyOrder : public testing::TestWithParam<int> {};

TEST_P(AnyOrder, OfSpringsAndPrismsGivesTheSameTissue) {
  const SyntheticSet set = set_of(GetParam());
  const MeshLoads loads = synthetic_loads(set, synthetic_pose(0.03, {0, 0, 0}));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> entry(-0.3, 0.3);
  Nodes x = set.rest, d = set.rest, g, g_shuffled;
  for (auto& p : x) p += Eigen::Vector3d(entry(random), entry(random), entry(random));
  for (auto& p : d) p = {entry(random), entry(random), entry(random)};
  SpringPrismEnergy energy(set.mesh, loads, 1);
  const double value = energy.value_and_gradient(x, g);
  const auto bend = energy.curvature(x, d);

  SpringPrismMesh mesh = set.mesh;
  const std::vector<int> springs = shuffled(mesh.spring_a.size(), random);
  for (auto* ends : {&mesh.spring_a, &mesh.spring_b}) reorder(*ends, springs);
  for (auto* of : {&mesh.rest_length, &mesh.stiffness}) reorder(*of, springs);
  const std::vector<int> prisms = shuffled(mesh.prisms.size(), random);
  reorder(mesh.prisms, prisms);
  for (auto* of : {&mesh.rest_volume, &mesh.volume_weight}) reorder(*of, prisms);
  for (std::size_t p = 0; p < mesh.prisms.size(); p += 2) {  // corners in another order: no stack
    auto& at = mesh.prisms[p];
    at = {at[3], at[5], at[4], at[0], at[2], at[1]};
  }
  const ElementBatches taken(mesh);
  EXPECT_LT(taken.edges.size(), 8u);
  EXPECT_GT(taken.spring_batches.size(), set.mesh.spring_a.size() / 2);
  EXPECT_GT(taken.prisms.size(), 0u);

  SpringPrismEnergy energy_shuffled(mesh, loads, 1);
  ASSERT_TRUE(std::isfinite(value));
  EXPECT_GT(value, 0.1);
  EXPECT_NEAR(energy_shuffled.value_and_gradient(x, g_shuffled), value, 1e-12 * value);
  EXPECT_NEAR(energy_shuffled.value(x), value, 1e-12 * value);
  for (std::size_t i = 0; i < g.size(); ++i)
    EXPECT_LT((g[i] - g_shuffled[i]).norm(), 1e-11 * (1 + g[i].norm()));
  const auto bend_shuffled = energy_shuffled.curvature(x, d);
  EXPECT_NEAR(bend_shuffled.exact, bend.exact, 1e-11 * bend.gauss_newton);
  EXPECT_NEAR(bend_shuffled.gauss_newton, bend.gauss_newton, 1e-11 * bend.gauss_newton);
}
INSTANTIATE_TEST_SUITE_P(ElementBatches, AnyOrder, testing::Values(1, 2, 3, 5));

}  // namespace
}  // namespace condyle
