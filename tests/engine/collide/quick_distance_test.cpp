#include "engine/collide/quick_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using test::box;
using test::sphere;

TEST(QuickDistance, EqualsTheExactDistanceWithItsSign) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> along(-1, 1);
  for (const TriMesh& mesh :
       {sphere(4, 20, {100, -60, 30}, 0.15), box({-30, 0, 10}, {40, 3, 90})}) {
    const QuickDistance quick(mesh);
    const TriangleTree exact(mesh);
    const Box bounds = bounding_box(mesh);
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector3d p =
          bounds.center() + 0.6 * bounds.size().cwiseProduct(
                                      Eigen::Vector3d(along(random), along(random), along(random)));
      const double truth = exact.signed_distance(p);
      QuickDistance::Start start;
      EXPECT_NEAR(quick.signed_distance(p), truth, 1e-4);
      // A limit, and where to start, change nothing but whether it is found.
      const float found =
          quick.signed_distance(p, static_cast<float>(std::abs(truth) + 1e-3), start);
      EXPECT_NEAR(found, truth, 1e-4);
      EXPECT_EQ(quick.signed_distance(p, 1e3f, start), quick.signed_distance(p, 1e3f, start));
      if (std::abs(truth) > 0.01) {
        EXPECT_TRUE(std::isinf(
            quick.signed_distance(p, static_cast<float>(std::abs(truth) - 5e-3), start)));
      }
      inside += truth < 0;
    }
    EXPECT_GT(inside, 400);
  }
}

}  // namespace
}  // namespace condyle
