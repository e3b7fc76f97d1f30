#include "engine/tissue/net_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "engine/tissue/synthetic_set.h"

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

/// Of `layers` in one bent slab.
SyntheticSet set_of(int layers) {
  SyntheticSize size = table1_size();
  size.layers = layers;
  size.boundary_sheets = {0};
  return make_synthetic_set(size);
}

TEST(NetRuns, TakeALayeredNetByItsColumns) {
  for (const int layers : {1, 2, 3, 5}) {
    const SyntheticSet set = set_of(layers);
    const NetRuns runs(set.net);
    const std::size_t parts = layers > 3 ? 2 : 1, columns = set.columns,
                      edges = edges_of(set.triangles).size();
    EXPECT_EQ(runs.edges.size(), (edges * parts + 3) / 4 * 4) << layers;
    EXPECT_EQ(runs.posts.size(), (columns * parts + 3) / 4 * 4) << layers;
    EXPECT_EQ(runs.stacks.size(), (set.triangles.size() * parts + 3) / 4 * 4) << layers;
    EXPECT_TRUE(runs.runs.empty()) << layers;
    EXPECT_TRUE(runs.prisms.empty()) << layers;
    const auto given = std::accumulate(set.net.stiffness.begin(), set.net.stiffness.end(), 0.0);
    EXPECT_NEAR(std::accumulate(runs.stiffness.begin(), runs.stiffness.end(), 0.0), given,
                1e-12 * given);
  }
}

/// What a kind of kernels makes of a net.
struct Told {
  std::vector<double> gradient, inverse_length;
  std::vector<double> sums;
};
Told told_by(const RunKernels& kernels, const NetRuns& runs, std::vector<double> x,
             std::vector<double> d) {
  const std::size_t row = x.size() / 3;
  const auto rows = [row](std::vector<double>& of) {
    return AxisRows{of.data(), of.data() + row, of.data() + 2 * row};
  };
  Told told;
  told.gradient.resize(x.size());
  told.inverse_length.resize(runs.rest_length.size());
  for (int half = 0; half < 2; ++half) {
    told.sums.push_back(
        kernels.springs(runs, half, 0.1, rows(x), rows(told.gradient), told.inverse_length.data()));
    told.sums.push_back(kernels.prisms(runs, half, 0.3, 0.5, rows(x), 0.7, rows(told.gradient)));
    const auto springs =
        kernels.springs_bend(runs, half, 0.1, rows(x), rows(d), told.inverse_length.data());
    const auto prisms = kernels.prisms_bend(runs, half, 0.3, 0.5, rows(x), rows(d));
    told.sums.insert(told.sums.end(),
                     {springs.exact, springs.gauss_newton, prisms.exact, prisms.gauss_newton});
  }
  return told;
}

TEST(NetRuns, EveryKindOfKernelsGivesTheSame) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> entry(-0.3, 0.3);
  for (const int layers : {1, 2, 3, 5}) {
    SyntheticSet set = set_of(layers);
    // Also springs that stand alone, many at a few nodes.
    for (int k = 0; k < 60; ++k) {
      set.net.spring_a.push_back(k % 7);
      set.net.spring_b.push_back(9 + (5 * k) % 8);
      set.net.rest_length.push_back(3);
      set.net.stiffness.push_back(0.5);
    }
    const NetRuns runs(set.net);
    EXPECT_FALSE(runs.runs.empty());
    const std::size_t row = set.rest.size() + NetRuns::lanes;
    std::vector<double> x(3 * row), d(3 * row);
    for (std::size_t i = 0; i < set.rest.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        x[k * row + i] = set.rest[i][static_cast<Eigen::Index>(k)] + entry(random);
        d[k * row + i] = entry(random);
      }
    const Told best = told_by(run_kernels(), runs, x, d);
    for (double sum : best.sums) ASSERT_TRUE(std::isfinite(sum));
    for (const RunKernels* kernels : usable_run_kernels()) {
      const Told told = told_by(*kernels, runs, x, d);
      const bool fused = kernels != usable_run_kernels().back();
      const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b) {
        double largest = 0;
        for (double v : b) largest = std::max(largest, std::abs(v));
        for (std::size_t i = 0; i < a.size(); ++i)
          if (fused)
            EXPECT_EQ(a[i], b[i]) << layers << " " << i;
          else
            EXPECT_NEAR(a[i], b[i], 1e-12 * largest) << layers << " " << i;
      };
      compare(told.gradient, best.gradient);
      compare(told.inverse_length, best.inverse_length);
      compare(told.sums, best.sums);
    }
  }
}

class AnyOrder : public testing::TestWithParam<int> {};

TEST_P(AnyOrder, OfSpringsAndPrismsIsTheSameTissue) {
  const SyntheticSet set = set_of(GetParam());
  const NetLoads loads = synthetic_loads(set, synthetic_pose(0.03, {0, 0, 0}));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> entry(-0.3, 0.3);
  Nodes x = set.rest, d = set.rest, g, g_shuffled;
  for (auto& p : x) p += Eigen::Vector3d(entry(random), entry(random), entry(random));
  for (auto& p : d) p = {entry(random), entry(random), entry(random)};
  SpringPrismEnergy energy(set.net, loads, 1);
  const double value = energy.value_and_gradient(x, g);
  const auto bend = energy.curvature(x, d);

  SpringPrismNet net = set.net;
  const std::vector<int> springs = shuffled(net.spring_a.size(), random);
  for (auto* ends : {&net.spring_a, &net.spring_b}) reorder(*ends, springs);
  for (auto* of : {&net.rest_length, &net.stiffness}) reorder(*of, springs);
  const std::vector<int> prisms = shuffled(net.prisms.size(), random);
  reorder(net.prisms, prisms);
  for (auto* of : {&net.rest_volume, &net.volume_weight}) reorder(*of, prisms);
  for (std::size_t p = 0; p < net.prisms.size(); p += 2) {  // corners in another order: no stack
    auto& at = net.prisms[p];
    at = {at[3], at[5], at[4], at[0], at[2], at[1]};
  }
  const NetRuns taken(net);
  EXPECT_LT(taken.edges.size(), 8u);
  EXPECT_GT(taken.runs.size(), set.net.spring_a.size() / 2);
  EXPECT_GT(taken.prisms.size(), 0u);

  SpringPrismEnergy energy_shuffled(net, loads, 1);
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
INSTANTIATE_TEST_SUITE_P(NetRuns, AnyOrder, testing::Values(1, 2, 3, 5));

}  // namespace
}  // namespace condyle
