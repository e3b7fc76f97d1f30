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

TEST(NetRuns, TakeMostOfALayeredNetTogether) {
  const SyntheticSet set = make_synthetic_set(patient2_size());
  const NetRuns runs(set.net);
  EXPECT_LT(3 * runs.springs.size(), set.net.spring_a.size());
  EXPECT_EQ(3 * runs.prisms.size(), set.net.prisms.size());
}

TEST(NetRuns, AnyOrderOfSpringsAndPrismsIsTheSameTissue) {
  SyntheticSet set = make_synthetic_set(table1_size());
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
  EXPECT_GT(NetRuns(net).springs.size(), 2 * NetRuns(set.net).springs.size());

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

}  // namespace
}  // namespace condyle
