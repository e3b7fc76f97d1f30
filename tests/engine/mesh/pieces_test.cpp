#include "engine/mesh/pieces.h"

#include <gtest/gtest.h>

#include "engine/mesh/repair.h"
#include "tests/engine/mesh/shapes.h"

namespace condyle {
namespace {

using test::arbitrary_pose;
using test::cuboid;
using test::joined;
using test::moved;

TEST(Pieces, SizesAreThoseOfTheBoxesAndSmallOnesAreDropped) {
  TriMesh cavity = cuboid({0.2, 0.2, 0.2}, {0.7, 0.7, 0.7});
  flip(cavity);
  const TriMesh one = cuboid({5, 0, 0}, {6, 2, 3});
  TriMesh mesh =
      moved(joined(joined(cuboid({0, 0, 0}, {1, 1, 1}), cavity), one), arbitrary_pose(1));
  const Components pieces = find_components(mesh);
  ASSERT_EQ(pieces.count, 3);
  const auto volumes = component_volumes(mesh, pieces);
  EXPECT_NEAR(volumes[0], 1, 1e-10);
  EXPECT_NEAR(volumes[1], -0.125, 1e-10);
  EXPECT_NEAR(volumes[2], 6, 1e-10);
  const auto areas = component_areas(mesh, pieces);
  EXPECT_NEAR(areas[1], 1.5, 1e-10);
  EXPECT_NEAR(areas[2], 22, 1e-10);
  EXPECT_EQ(drop_components_below(mesh, pieces, volumes, 2), 2);
  EXPECT_EQ(mesh.vertices.size(), one.vertices.size());
  EXPECT_NEAR(signed_volume(mesh), 6, 1e-10);
}

}  // namespace
}  // namespace condyle
