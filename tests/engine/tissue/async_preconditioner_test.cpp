#include "engine/tissue/async_preconditioner.h"

#include <gtest/gtest.h>

#include <memory>

#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const HessianFactor> factor_at_rest(const SyntheticSet& set) {
  return std::make_shared<const HessianFactor>(set.mesh, synthetic_loads(set, Pose{}), set.sheets,
                                               set.rest);
}

Nodes solved(const HessianFactor& factor, const SyntheticSet& set) {
  Nodes z;
  factor.solve(Nodes(set.rest.size(), Vector3d(1, -2, 0.5)), z);
  return z;
}

TEST(AsyncPreconditioner, ItsLagIsFixedBySize) {
  const auto lag_of = [](const SyntheticSize& size) {
    return AsyncPreconditioner::lag(*factor_at_rest(make_synthetic_set(size)));
  };
  EXPECT_EQ(lag_of(table1_size()), 1);
  EXPECT_EQ(lag_of(patient2_size()), 1);
  EXPECT_EQ(lag_of(size_of_nodes(10000)), 5);
}

TEST(AsyncPreconditioner, ItsLagIsShorterWhereFramesTakeManyIterations) {
  const auto factor = factor_at_rest(make_synthetic_set(size_of_nodes(10000)));
  EXPECT_EQ(AsyncPreconditioner::lag(*factor, 1), 5);
  const double iterations = factor->iterations_per_factorization() - 8;
  EXPECT_EQ(AsyncPreconditioner::lag(*factor, static_cast<int>(iterations) + 1), 2);
  EXPECT_EQ(AsyncPreconditioner::lag(*factor, static_cast<int>(iterations / 3) + 1), 4);
  // A factor of a small mesh is due in the next frame anyway.
  EXPECT_EQ(AsyncPreconditioner::lag(*factor_at_rest(make_synthetic_set(table1_size())), 100), 1);
}

TEST(AsyncPreconditioner, AFactorIsUsedFromItsFrameOnWithTheSameBitsForAnyThreads) {
  const SyntheticSet set = make_synthetic_set(size_of_nodes(6000));
  const auto first = factor_at_rest(set);
  const int lag = AsyncPreconditioner::lag(*first);
  ASSERT_GT(lag, 1);
  const MeshLoads loads = synthetic_loads(set, synthetic_pose(0.02, Vector3d::Zero()));
  const Nodes x = carried(set, set.rest, Pose{}, synthetic_pose(0.02, Vector3d::Zero()));
  std::vector<Nodes> steps;
  for (const int threads : {1, 2}) {
    AsyncPreconditioner rolling(first);
    rolling.begin(set.mesh, loads, x, threads, nullptr);
    for (int frame = 1; frame < lag; ++frame) {
      rolling.advance();
      EXPECT_EQ(&rolling.now(), first.get()) << frame;
    }
    rolling.advance();
    EXPECT_NE(&rolling.now(), first.get());
    steps.push_back(solved(rolling.now(), set));
  }
  EXPECT_EQ(steps[0], steps[1]);
  EXPECT_NE(steps[0], solved(*first, set));
}

TEST(AsyncPreconditioner, AFactorComputedWithinAFrameIsNotReplacedByAnEarlierOne) {
  const SyntheticSet set = make_synthetic_set(size_of_nodes(6000));
  const auto first = factor_at_rest(set);
  const auto within_frame = factor_at_rest(set);
  const MeshLoads loads = synthetic_loads(set, Pose{});
  AsyncPreconditioner rolling(first);
  rolling.begin(set.mesh, loads, set.rest, 2, nullptr);
  rolling.advance();
  rolling.replace(within_frame);
  for (int frame = 0; frame < 2 * AsyncPreconditioner::lag(*first); ++frame) rolling.advance();
  EXPECT_EQ(&rolling.now(), within_frame.get());
  // The next one is.
  rolling.begin(set.mesh, loads, set.rest, 2, nullptr);
  for (int frame = 0; frame < AsyncPreconditioner::lag(*first); ++frame) rolling.advance();
  EXPECT_NE(&rolling.now(), within_frame.get());
}

}  // namespace
}  // namespace condyle
