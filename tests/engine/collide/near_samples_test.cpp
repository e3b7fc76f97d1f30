#include "engine/collide/near_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

TEST(NearSamples, AroundPointsAreThoseFoundByEachDistance) {
  const SurfaceSamples samples = sample_surface(test::sphere(3, 20));
  ASSERT_GT(samples.points.size(), 5000u);
  std::mt19937 random(7);
  std::uniform_int_distribution<std::size_t> any(0, samples.points.size() - 1);
  for (const int count : {0, 1, 30}) {
    std::vector<Vector3d> places;
    for (int i = 0; i < count; ++i) places.push_back(samples.points[any(random)]);
    for (const double reach : {0.3, 4.0, 60.0}) {
      std::vector<int> expected;
      for (std::size_t i = 0; i < samples.points.size(); ++i)
        if (std::any_of(places.begin(), places.end(), [&](const Vector3d& p) {
              return (samples.points[i] - p).squaredNorm() < reach * reach;
            }))
          expected.push_back(static_cast<int>(i));
      EXPECT_EQ(samples_around(samples, places, reach), expected) << count << ", " << reach;
      EXPECT_EQ(expected.empty(), count == 0);
    }
  }
}

}  // namespace
}  // namespace condyle
