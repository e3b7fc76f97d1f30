#include "engine/collide/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <random>

#include "engine/core/files.h"
#include "tests/support/program.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Checks a box and all below it; returns the triangles, in the order of the leaves.
std::vector<int> checked(const TriMesh& mesh, const BoxTree& tree, std::size_t pair,
                         std::size_t which, int depth) {
  const BoxPair& boxes = tree.boxes[pair];
  const int held = boxes.node[which], region = tree.region[pair][which];
  EXPECT_EQ(region >= 0, depth >= BoxTree::region_depth);
  EXPECT_LT(region, BoxTree::region_count);
  std::vector<int> triangles;
  if (holds_triangle(held)) {
    triangles.push_back(held_triangle(held));
  } else {
    for (const std::size_t k : {0u, 1u}) {
      const auto part = checked(mesh, tree, static_cast<std::size_t>(held), k, depth + 1);
      triangles.insert(triangles.end(), part.begin(), part.end());
      if (region >= 0) {
        EXPECT_EQ(int(tree.region[static_cast<std::size_t>(held)][k]), region);
      }
    }
  }
  const Vector3d center(boxes.center[0][which], boxes.center[1][which], boxes.center[2][which]);
  const double rounding = 1e-5 * (1 + tree.reach_mm);
  for (const int t : triangles)
    for (const int v : mesh.triangles[static_cast<std::size_t>(t)]) {
      const Vector3d p = mesh.vertices[static_cast<std::size_t>(v)];
      EXPECT_LE(p.norm(), tree.reach_mm + rounding);
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d along(boxes.axes[axis][0][which], boxes.axes[axis][1][which],
                             boxes.axes[axis][2][which]);
        EXPECT_NEAR(along.norm(), 1, 1e-6);
        EXPECT_LE(std::abs(along.dot(p - center)), double(boxes.half[axis][which]) + rounding);
      }
    }
  return triangles;
}

void expect_sound(const TriMesh& mesh) {
  const BoxTree tree(mesh);
  std::vector<int> triangles = checked(mesh, tree, 0, 0, 0);
  std::sort(triangles.begin(), triangles.end());
  ASSERT_EQ(triangles.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) EXPECT_EQ(triangles[i], static_cast<int>(i));
}

TEST(BoxTree, EachBoxHoldsItsTrianglesAndEachTriangleHasALeaf) {
  expect_sound(test::sphere(3, 5, {40, -200, 7}, 0.04));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-50, 50);
  TriMesh soup;
  for (int i = 0; i < 300; ++i) {
    for (int k = 0; k < 3; ++k) soup.vertices.emplace_back(any(random), any(random), any(random));
    soup.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  expect_sound(soup);
}

TEST(BoxTree, TrianglesWithoutAreaAndEqualOnesHaveBoxesToo) {
  TriMesh mesh;
  mesh.vertices = {{1, 2, 3}, {4, 2, 3}, {1, 9, 3}, {1, 2, 3}};
  for (int i = 0; i < 5; ++i)
    mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 0}, {0, 1, 1}, {0, 1, 2}, {0, 3, 0}});
  expect_sound(mesh);
  mesh.triangles = {{2, 2, 2}};
  expect_sound(mesh);
}

TEST(BoxTree, BoxesOfAFlatStripLieAlongIt) {
  const double length = 30, width = 2;
  const Vector3d u = Vector3d(1, 2, 2).normalized(), v = Vector3d(2, 1, -2).normalized();
  TriMesh strip;
  strip.vertices = {0 * u, length * u, length * u + width * v, width * v};
  strip.triangles = {{0, 1, 2}, {0, 2, 3}};
  const BoxTree tree(strip);
  std::array<float, 3> half{tree.boxes[0].half[0][0], tree.boxes[0].half[1][0],
                            tree.boxes[0].half[2][0]};
  std::sort(half.begin(), half.end());
  EXPECT_NEAR(half[0], 0, 1e-5);
  EXPECT_LT(half[1], width);
  EXPECT_LT(half[2], 0.5 * (length + width));
}

TEST(BoxTree, ReadFromTheCacheIsTheSameToTheBitAndADamagedOneIsBuiltAgain) {
  const TriMesh mesh = test::sphere(5, 12, {3, -4, -13}, 0.02);
  const BoxTree built(mesh);
  const auto same = [&](const BoxTree& tree) {
    return tree.reach_mm == built.reach_mm && tree.region == built.region &&
           tree.boxes.size() == built.boxes.size() &&
           std::memcmp(tree.boxes.data(), built.boxes.data(),
                       built.boxes.size() * sizeof(BoxPair)) == 0;
  };
  const test::Folder folder;
  EXPECT_TRUE(same(BoxTree::stored(mesh, folder.path())));
  const auto file = std::filesystem::directory_iterator(folder.path())->path();
  const std::string whole = read_file(file);
  EXPECT_TRUE(same(BoxTree::stored(mesh, folder.path())));
  std::string damaged = whole;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  for (const std::string& bytes : {damaged, whole.substr(0, whole.size() / 2), std::string()}) {
    write_file(file, bytes);
    EXPECT_TRUE(same(BoxTree::stored(mesh, folder.path())));
    EXPECT_EQ(read_file(file), whole);
  }
  TriMesh other = mesh;
  other.vertices[7].x() += 1e-9;
  BoxTree::stored(other, folder.path());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

}  // namespace
}  // namespace condyle
