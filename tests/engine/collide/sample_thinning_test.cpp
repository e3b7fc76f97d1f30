#include "engine/collide/sample_thinning.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/collide/surface_samples.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

TEST(SampleThinning, EachSampleThatIsDroppedHasOneNearbyThatStandsForIt) {
  const TriMesh bumpy = test::sphere(5, 4, {0, 0, 0}, 0.05);
  const SampleSettings settings{.region = {}};
  SampleSettings whole = settings;
  whole.thin_fraction = 0;
  const SurfaceSamples few = sample_surface(bumpy, settings), all = sample_surface(bumpy, whole);
  EXPECT_LT(few.points.size(), 0.8 * static_cast<double>(all.points.size()));
  const double reach = settings.thin_fraction * settings.spacing_mm;
  int dropped = 0;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    double nearest = 1, rise = 1;
    for (std::size_t k = 0; k < few.points.size(); ++k) {
      const Vector3d offset = all.points[i] - few.points[k];
      if (offset.norm() > reach || all.normals[i].dot(few.normals[k]) < 0.95) continue;
      nearest = std::min(nearest, offset.norm());
      rise = std::min(rise, std::abs(offset.dot(few.normals[k])));
    }
    EXPECT_LE(nearest, reach) << i;
    EXPECT_LE(rise, settings.edge_rise_mm) << i;
    dropped += nearest > 0;
  }
  EXPECT_GT(dropped, 100);
}

TEST(SampleThinning, SharpEdgesKeepTheirSamples) {
  SamplePoints places;
  for (int i = 0; i < 100; ++i) {
    places.points.emplace_back(0.1 * i, 0, 0);
    places.normals.push_back(Vector3d(0, 1, 1).normalized());
    places.spread.push_back(static_cast<float>(std::sqrt(0.5)));  // of a cube's edge
  }
  EXPECT_EQ(thinned(places, 0.3, 0.03).points.size(), 100u);
  places.spread.assign(100, 1.0f);
  const std::size_t flat = thinned(places, 0.3, 0.03).points.size();
  EXPECT_GE(flat, 17u);  // one at least every 0.6 mm
  EXPECT_LE(flat, 50u);
}

TEST(SampleThinning, ATurnedSurfaceKeepsTheSameSamples) {
  const TriMesh bumpy = test::sphere(4, 4, {0, 0, 0}, 0.05);
  const Pose X{Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized())),
               Vector3d(3, 50, -20)};
  const SurfaceSamples here = sample_surface(bumpy), there = sample_surface(test::moved(bumpy, X));
  EXPECT_NEAR(static_cast<double>(here.points.size()), static_cast<double>(there.points.size()),
              0.02 * static_cast<double>(here.points.size()));
}

}  // namespace
}  // namespace condyle
