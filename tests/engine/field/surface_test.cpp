#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/field/decimate.h"
#include "engine/field/isosurface.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

FieldRecipe ball(double radius, Symmetry symmetry = Symmetry::none) {
  FieldRecipe recipe(symmetry);
  recipe.add(ellipsoid({0, 0, 0}, Vector3d::Constant(radius)), 0);
  return recipe;
}

/// A ring with a ball joined to it: genus 1, curvature of both signs.
FieldRecipe ring_and_ball() {
  FieldRecipe recipe;
  std::vector<Vector3d> circle;
  for (int i = 0; i <= 24; ++i) {
    const double a = 2 * std::numbers::pi * i / 24;
    circle.emplace_back(10 * std::cos(a), 10 * std::sin(a), 0);
  }
  recipe.add(tube(circle, std::vector<double>(circle.size(), 3.0), 2), 0);
  recipe.add(ellipsoid({10, 0, 0}, {4, 5, 6}), 3);
  return recipe;
}

Eigen::AlignedBox3d cube(double half) {
  return {Vector3d::Constant(-half), Vector3d::Constant(half)};
}

int euler_number(const TriMesh& mesh) {
  return static_cast<int>(mesh.vertices.size()) - static_cast<int>(find_edges(mesh).edges.size()) +
         static_cast<int>(mesh.triangles.size());
}

TEST(SampledField, SkippedBlocksLeaveTheSurfaceAsItIs) {
  const auto recipe = ring_and_ball();
  const auto grid = even_grid(cube(17), 0.5);
  const auto quick = sample_field(recipe, grid);
  const auto whole = sample_field(recipe, grid, {.band = 1e3});
  std::size_t differ = 0;
  for (std::size_t i = 0; i < whole.values.size(); ++i)
    differ += quick.values[i] != whole.values[i];
  EXPECT_GT(differ, whole.values.size() / 3);  // blocks were skipped
  EXPECT_EQ(mesh_hash(isosurface(quick)), mesh_hash(isosurface(whole)));
}

TEST(SampledField, SamplesAreBitIdenticalOnOneAndTwoThreads) {
  const auto grid = even_grid(cube(17), 0.7);
  EXPECT_EQ(sample_field(ring_and_ball(), grid, {.threads = 1}).values,
            sample_field(ring_and_ball(), grid, {.threads = 2}).values);
}

TEST(SampledField, MirroredRecipesFillBothHalves) {
  FieldRecipe pair(Symmetry::mirror_x);
  pair.add(ellipsoid({6, 1, 0}, {3, 2, 2}), 0);
  pair.add(ellipsoid({11, 1, 2}, {2, 2, 2}), 2);
  const auto mesh = isosurface(sample_field(pair, even_grid(cube(15), 0.5)));
  EXPECT_EQ(inspect(mesh).components, 2);
  for (const auto& p : mesh.vertices) ASSERT_LT(std::abs(pair(p)), 0.1);
  const auto right = std::count_if(mesh.vertices.begin(), mesh.vertices.end(),
                                   [](const Vector3d& p) { return p.x() < 0; });
  EXPECT_EQ(2 * static_cast<std::size_t>(right), mesh.vertices.size());
}

TEST(SampledField, TrilinearValueIsExactForLinearFields) {
  FieldRecipe plane;
  plane.keep({[](const Vector3d& p) { return 60 + 0.3 * p.x() - 0.5 * p.y() + 0.2 * p.z(); },
              unbounded_box()},
             0);
  const auto field = sample_field(
      plane, {even_axis(-2, 2, .5), graded_axis(-2, 2, 1, -.5, .5, .2), even_axis(-2, 2, .4)},
      {.band = 1e3});
  for (double t = -1.9; t < 1.9; t += 0.17)
    EXPECT_NEAR(field({t, -t * .7, .5 * t}), 60 + 0.3 * t + 0.35 * t + 0.1 * t, 1e-5);
}

TEST(SampledField, GradedAxisIsFineInsideItsStretch) {
  const auto axis = graded_axis(-10, 20, 2, 0, 5, 0.5);
  EXPECT_EQ(axis.front(), -10);
  EXPECT_GE(axis.back(), 20);
  for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
    const double step = axis[i + 1] - axis[i];
    EXPECT_GT(step, 0.49);
    EXPECT_LT(step, 2.01);
    if (axis[i] > 0 && axis[i + 1] < 5) {
      EXPECT_NEAR(step, 0.5, 1e-9);
    }
  }
}

TEST(Isosurface, IsClosedAndManifoldForAnySigns) {
  // White noise holds every sign pattern, the ambiguous ones among them.
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(-1, 1);
  SampledField field{even_grid(cube(6), 0.5), {}};
  const auto size = field.size();
  for (int i = 0; i < size.x(); ++i)
    for (int j = 0; j < size.y(); ++j)
      for (int k = 0; k < size.z(); ++k) {
        const bool rim = i == 0 || j == 0 || k == 0 || i + 1 == size.x() || j + 1 == size.y() ||
                         k + 1 == size.z();
        field.values.push_back(rim ? 1.0f : value(random));
      }
  const auto mesh = isosurface(field);
  const auto topology = inspect(mesh);
  EXPECT_GT(mesh.triangles.size(), 10000u);
  EXPECT_TRUE(topology.closed());
  EXPECT_GT(topology.volume_mm3, 0);
}

TEST(Isosurface, OfABallHasItsVolumeAndArea) {
  const auto mesh = isosurface(sample_field(ball(8), even_grid(cube(9), 0.4)));
  const double r = 8, pi = std::numbers::pi;
  EXPECT_TRUE(inspect(mesh).closed());
  EXPECT_EQ(euler_number(mesh), 2);
  EXPECT_NEAR(signed_volume(mesh), 4 * pi * r * r * r / 3, 12);
  EXPECT_NEAR(surface_area(mesh), 4 * pi * r * r, 4);
  for (const auto& p : mesh.vertices) ASSERT_NEAR(p.norm(), r, 0.02);
}

TEST(Isosurface, HalfAndMirrorImageMakeAClosedSymmetricWhole) {
  const auto grid = even_grid({Vector3d(0, -9, -9), Vector3d(9, 9, 9)}, 0.5);
  const auto half = isosurface(sample_field(ball(8), grid));
  EXPECT_GT(inspect(half).boundary_edges, 0);
  const auto thin = decimated(half, {.target_triangles = 400});
  EXPECT_LT(thin.triangles.size(), half.triangles.size() / 3);
  for (const auto* part : {&half, &thin}) {
    const auto whole = with_mirror_image(*part);
    const auto topology = inspect(whole);
    EXPECT_TRUE(topology.closed());
    EXPECT_EQ(topology.components, 1);
    EXPECT_NEAR(topology.volume_mm3, 2 * signed_volume(*part), 1e-6);
  }
}

TEST(Isosurface, ClippingKeepsTheNegativeSide) {
  const auto mesh = isosurface(sample_field(ball(8), even_grid(cube(9), 0.5)));
  std::vector<double> height;
  for (const auto& p : mesh.vertices) height.push_back(p.z() - 3);
  const auto bowl = clipped(mesh, height);
  const auto topology = inspect(bowl);
  EXPECT_EQ(topology.boundary.size(), 1u);
  EXPECT_EQ(topology.nonmanifold_edges, 0);
  for (const auto& p : bowl.vertices) ASSERT_LT(p.z(), 3.05);
  EXPECT_NEAR(surface_area(bowl), 2 * std::numbers::pi * 8 * 11, 3);
}

TEST(Isosurface, LargestPieceDropsBubbles) {
  FieldRecipe two;
  two.add(ellipsoid({0, 0, 0}, {3, 3, 3}), 0);
  two.add(ellipsoid({7, 0, 0}, {1, 1, 1}), 0);
  const auto both = isosurface(sample_field(two, even_grid(cube(9), 0.4)));
  EXPECT_EQ(inspect(both).components, 2);
  const auto one = largest_piece(both);
  EXPECT_EQ(inspect(one).components, 1);
  EXPECT_NEAR(signed_volume(one), 36 * std::numbers::pi, 1.5);
}

TEST(Decimation, KeepsTopologyAndShape) {
  const auto recipe = ring_and_ball();
  const auto mesh = isosurface(sample_field(recipe, even_grid(cube(17), 0.4)));
  const auto thin = decimated(mesh, {.target_triangles = 2500});
  const auto topology = inspect(thin);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(euler_number(thin), 0);  // one handle, as before
  EXPECT_LE(thin.triangles.size(), 2500u);
  EXPECT_GT(mesh.triangles.size(), 15000u);
  EXPECT_NEAR(topology.volume_mm3 / signed_volume(mesh), 1, 0.01);
  for (const auto& t : thin.triangles) {  // centres lie on the surface, turned outward
    const Vector3d &a = thin.vertices[static_cast<std::size_t>(t[0])],
                   &b = thin.vertices[static_cast<std::size_t>(t[1])],
                   &c = thin.vertices[static_cast<std::size_t>(t[2])];
    const Vector3d center = (a + b + c) / 3, n = (b - a).cross(c - a).normalized();
    ASSERT_LT(std::abs(recipe(center)), 0.12);
    ASSERT_GT(recipe(center + 0.3 * n), recipe(center - 0.3 * n));
  }
}

TEST(Decimation, ImportantRegionsKeepSmallerTriangles) {
  const auto mesh = isosurface(sample_field(ball(8), even_grid(cube(9), 0.4)));
  const auto thin =
      decimated(mesh, {.target_triangles = 1500,
                       .importance = [](const Vector3d& p) { return p.z() > 0 ? 300.0 : 1.0; },
                       .evenness = 0.05});
  std::size_t above = 0;
  for (const auto& t : thin.triangles)
    above += thin.vertices[static_cast<std::size_t>(t[0])].z() > 0;
  EXPECT_GT(above, 2 * (thin.triangles.size() - above));
}

TEST(Decimation, SameMeshGivesBitIdenticalResults) {
  const auto mesh = isosurface(sample_field(ring_and_ball(), even_grid(cube(17), 0.6)));
  EXPECT_EQ(mesh_hash(decimated(mesh, {.target_triangles = 1000})),
            mesh_hash(decimated(mesh, {.target_triangles = 1000})));
}

}  // namespace
}  // namespace condyle
