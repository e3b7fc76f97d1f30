#include <gtest/gtest.h>

#include <algorithm>

#include "engine/mesh/simplify.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/engine/mesh/shapes.h"

namespace condyle {
namespace {

std::vector<Eigen::Vector3f> floats(const TriMesh& mesh) {
  std::vector<Eigen::Vector3f> all;
  for (const auto& v : mesh.vertices) all.push_back(v.cast<float>());
  return all;
}

TEST(Coarser, StaysCloseAndClosedOnTheSameVertices) {
  const TriMesh mesh = test::sphere(5, 40);
  const int count = static_cast<int>(mesh.triangles.size());
  const TriMesh coarse{mesh.vertices, coarser(floats(mesh), mesh.triangles, count / 4, 0.2), {}};
  EXPECT_LE(coarse.triangles.size(), mesh.triangles.size() / 4 + 8);
  EXPECT_TRUE(inspect(coarse).closed());
  const TriangleTree tree(coarse);
  double farthest = 0;
  for (const auto& v : mesh.vertices)
    farthest = std::max(farthest, (tree.nearest(v).point - v).norm());
  EXPECT_LT(farthest, 0.4);
  EXPECT_GT(farthest, 0.01);
}

TEST(Coarser, KeepsWhatMayNotMove) {
  const TriMesh mesh = test::sphere(4, 40);
  const auto positions = floats(mesh);
  EXPECT_GT(coarser(positions, mesh.triangles, 10, 0.01).size(), 400u);
  EXPECT_EQ(coarser(positions, mesh.triangles, 1 << 20, 5).size(), mesh.triangles.size());
}

}  // namespace
}  // namespace condyle
