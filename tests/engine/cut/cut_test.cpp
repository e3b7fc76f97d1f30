#include "engine/cut/cut.h"

#include <gtest/gtest.h>

#include <numbers>

#include "engine/core/error.h"
#include "engine/mesh/topology.h"
#include "tests/engine/cut/cut_checks.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using test::box;
using test::expect_whole;

Cut flat_cut(double z, double kerf = 0, std::vector<Plane> reach = {}) {
  return {"flat", Region::above({Eigen::Vector3d::UnitZ(), z}, 3), std::move(reach), kerf};
}

TEST(CutBone, DividesABallIntoCapsOfTheRightVolume) {
  const TriMesh ball = test::sphere(5, 20);
  const std::vector<Cut> cuts{flat_cut(5, 1)};
  const CutResult result = cut_bone(ball, cuts);
  expect_whole(ball, result);
  ASSERT_EQ(result.pieces.size(), 2U);
  // A cap of height h: pi h^2 (r - h / 3); the polyhedron has 0.3 % less.
  const auto cap = [](double h) { return std::numbers::pi * h * h * (20 - h / 3); };
  EXPECT_NEAR(result.pieces[0].volume_mm3 / cap(24.5), 1, 4e-3);
  EXPECT_NEAR(result.pieces[1].volume_mm3 / cap(14.5), 1, 4e-3);
  EXPECT_EQ(result.pieces[0].sides[0], CutSide::below);
  EXPECT_EQ(result.pieces[1].sides[0], CutSide::above);
  EXPECT_TRUE(result.outcomes[0].through);
  const double rim = std::numbers::pi * (400 - 25);
  EXPECT_NEAR(result.outcomes[0].wall_area_mm2, 2 * rim, 0.01 * rim);
  EXPECT_NEAR(result.kerf_volume_mm3, rim, 0.01 * rim);
}

TEST(CutBone, MarksCutFacesAndNamesTheTriangleOfTheOthers) {
  const TriMesh ball = test::sphere(3, 20);
  const std::vector<Cut> cuts{flat_cut(5)};
  const CutResult result = cut_bone(ball, cuts);
  for (const Piece& piece : result.pieces)
    for (std::size_t i = 0; i < piece.source.size(); ++i) {
      const auto& t = piece.mesh.triangles[i];
      if (piece.source[i] < 0) {
        EXPECT_EQ(piece.wall[i], 3);
        for (const int v : t) EXPECT_NEAR(piece.mesh.vertices[v].z(), 5, 1e-9);
        continue;
      }
      const auto& original = ball.triangles[piece.source[i]];
      const Eigen::Vector3d &a = ball.vertices[original[0]], &b = ball.vertices[original[1]],
                            &c = ball.vertices[original[2]];
      const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
      for (const int v : t) EXPECT_NEAR(normal.dot(piece.mesh.vertices[v] - a), 0, 1e-9);
    }
}

TEST(CutBone, BoneOutOfReachKeepsItsTriangles) {
  const TriMesh ball = test::sphere(5, 20);
  const std::vector<Cut> cuts{flat_cut(16, 0.5, box_planes({-15, -15, 10}, {15, 15, 25}))};
  const CutResult result = cut_bone(ball, cuts);
  expect_whole(ball, result);
  ASSERT_EQ(result.pieces.size(), 2U);
  int far = 0;
  const Piece& body = result.pieces[0];
  for (std::size_t i = 0; i < body.source.size(); ++i) {
    if (body.source[i] < 0) continue;
    const auto& original = ball.triangles[body.source[i]];
    double top = -100;
    for (const int v : original) top = std::max(top, ball.vertices[v].z());
    if (top > 15.7) continue;  // at the cut
    ++far;
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(body.mesh.vertices[body.mesh.triangles[i][k]], ball.vertices[original[k]]);
  }
  EXPECT_GT(far, 10000) << "the triangles that the boundary of the reach crosses, too";
}

TEST(CutBone, ACutThatEndsInTheBoneStatesWhatIsLeftAndWhere) {
  const TriMesh bar = box({0, 0, 0}, {40, 10, 10});
  const std::vector<Cut> cuts{{"half", Region::above({Eigen::Vector3d::UnitX(), 20}, 0),
                               box_planes({10, -1, -1}, {30, 7, 11}), 0.6}};
  const CutResult result = cut_bone(bar, cuts);
  expect_whole(bar, result);
  ASSERT_EQ(result.pieces.size(), 1U);
  const CutOutcome& outcome = result.outcomes[0];
  EXPECT_TRUE(outcome.meets_bone);
  EXPECT_FALSE(outcome.through);
  EXPECT_NEAR(outcome.left_mm, 3, 1e-9);
  EXPECT_NEAR(outcome.left_at.y(), 8.5, 1e-9);
  EXPECT_NEAR(outcome.left_at.x(), 20, 0.31);
  EXPECT_NEAR(result.kerf_volume_mm3, 0.6 * 7 * 10, 1e-9);
  EXPECT_EQ(result.pieces[0].sides[0], CutSide::neither);
}

TEST(CutBone, ACutThatMissesChangesNothing) {
  const TriMesh ball = test::sphere(2, 20);
  const std::vector<Cut> cuts{flat_cut(30, 1)};
  const CutResult result = cut_bone(ball, cuts);
  EXPECT_FALSE(result.outcomes[0].meets_bone);
  ASSERT_EQ(result.pieces.size(), 1U);
  EXPECT_EQ(result.pieces[0].mesh.triangles.size(), ball.triangles.size());
}

TEST(CutBone, SheetsBendAndTheirWallsMeet) {
  const TriMesh bar = box({0, 0, 0}, {40, 10, 10});
  const std::vector<Eigen::Vector3d> polyline{{15, 0, -5}, {15, 0, 5}, {25, 0, 5}, {25, 0, 15}};
  const std::vector<Cut> cuts{
      {"step", beyond_sheet(polyline, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()), {}, 1}};
  const CutResult result = cut_bone(bar, cuts);
  expect_whole(bar, result);
  ASSERT_EQ(result.pieces.size(), 2U);
  // The middle line of the kerf is 4.5 + 10 + 4.5 mm long inside and outside alike.
  EXPECT_NEAR(result.kerf_volume_mm3, 10 * (5 + 10 + 5), 1e-9);
  EXPECT_NEAR(result.pieces[0].volume_mm3, result.pieces[1].volume_mm3, 1e-6);
  std::set<int> walls(result.pieces[0].wall.begin(), result.pieces[0].wall.end());
  EXPECT_EQ(walls, (std::set<int>{-1, 0, 1, 2}));
}

TEST(CutBone, SidesCombine) {
  const TriMesh cube = box({0, 0, 0}, {10, 10, 10});
  const Region right = Region::above({Eigen::Vector3d::UnitX(), 6}, 0),
               top = Region::above({Eigen::Vector3d::UnitZ(), 7}, 1);
  for (const bool all : {true, false}) {
    const std::vector<Cut> cuts{{"corner", all ? both(right, top) : either(right, top), {}, 0}};
    const CutResult result = cut_bone(cube, cuts);
    expect_whole(cube, result);
    ASSERT_EQ(result.pieces.size(), 2U);
    const double above = all ? 4 * 3 * 10 : 1000 - 6 * 7 * 10;
    for (const Piece& piece : result.pieces)
      EXPECT_NEAR(piece.volume_mm3, piece.sides[0] == CutSide::above ? above : 1000 - above, 1e-9);
  }
}

TEST(CutBone, TwoCutsThatCrossAreReported) {
  const TriMesh cube = box({0, 0, 0}, {10, 10, 10});
  for (const double kerf : {0.0, 0.5}) {
    const std::vector<Cut> cuts{{"x", Region::above({Eigen::Vector3d::UnitX(), 4}), {}, kerf},
                                {"z", Region::above({Eigen::Vector3d::UnitZ(), 4}), {}, kerf}};
    const CutResult result = cut_bone(cube, cuts);
    expect_whole(cube, result);
    EXPECT_EQ(result.pieces.size(), 4U);
    ASSERT_EQ(result.crossings.size(), 1U);
    EXPECT_EQ(result.crossings[0], std::pair(0, 1));
    // Parallel ones do not cross.
    const std::vector<Cut> parallel{cuts[0],
                                    {"x", Region::above({Eigen::Vector3d::UnitX(), 8}), {}, kerf}};
    EXPECT_TRUE(cut_bone(cube, parallel).crossings.empty());
  }
}

TEST(CutBone, CavitiesStayInTheirPiece) {
  TriMesh inner = test::sphere(3, 5, {0, 0, -8});
  for (auto& t : inner.triangles) std::swap(t[0], t[1]);
  const TriMesh shell = test::joined(test::sphere(4, 20), inner);
  const std::vector<Cut> cuts{flat_cut(2, 0.4)};
  const CutResult result = cut_bone(shell, cuts);
  expect_whole(shell, result);
  ASSERT_EQ(result.pieces.size(), 2U);
  // Both halves are alike but for the cavity and the plane's height.
  EXPECT_EQ(inspect(result.pieces[1].mesh).components,
            inspect(result.pieces[0].mesh).components == 1 ? 2 : 1);
}

TEST(CutBone, ACutThroughACavityHasAHole) {
  TriMesh inner = test::sphere(3, 5);
  for (auto& t : inner.triangles) std::swap(t[0], t[1]);
  const TriMesh shell = test::joined(test::sphere(4, 20), inner);
  const std::vector<Cut> cuts{flat_cut(1)};
  const CutResult result = cut_bone(shell, cuts);
  expect_whole(shell, result);
  ASSERT_EQ(result.pieces.size(), 2U);
  EXPECT_NEAR(result.outcomes[0].wall_area_mm2 / 2, std::numbers::pi * (399 - 24), 10);
}

TEST(CutBone, ColoursOfNewVerticesLieBetweenThoseOfTheirEdge) {
  TriMesh cube = box({0, 0, 0}, {10, 10, 10});
  for (const auto& v : cube.vertices) cube.colors.push_back((0.1 * v).cast<float>());
  const std::vector<Cut> cuts{{"z", Region::above({Eigen::Vector3d::UnitZ(), 2.5}), {}, 0}};
  for (const Piece& piece : cut_bone(cube, cuts).pieces) {
    ASSERT_EQ(piece.mesh.colors.size(), piece.mesh.vertices.size());
    for (std::size_t i = 0; i < piece.mesh.vertices.size(); ++i)
      EXPECT_LT((piece.mesh.colors[i] - (0.1 * piece.mesh.vertices[i]).cast<float>()).norm(), 1e-6);
  }
}

TEST(CutBone, WhatCannotBeCutIsRefused) {
  TriMesh open = test::sphere(2, 20);
  open.triangles.pop_back();
  EXPECT_THROW(cut_bone(open, std::vector{flat_cut(0)}), InputError);
  const TriMesh ball = test::sphere(2, 20);
  for (const double kerf : {-1.0, 1e-6, 2.1, std::nan("")})
    EXPECT_THROW(cut_bone(ball, std::vector{flat_cut(0, kerf)}), InputError) << kerf;
  EXPECT_THROW(cut_bone(ball, std::vector{flat_cut(std::nan(""))}), InputError);
  const std::vector<Eigen::Vector3d> folded{{0, 0, 0}, {10, 0, 0}, {1, 0, 1}};
  EXPECT_THROW(beyond_sheet(folded, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()),
               InputError);
  const std::vector<Eigen::Vector3d> along{{0, 0, 0}, {0, 5, 0}};
  EXPECT_THROW(beyond_sheet(along, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()), InputError);
}

TEST(CutBone, IsDeterministic) {
  const TriMesh ball = test::sphere(4, 20, {0, 0, 0}, 0.1);
  const std::vector<Cut> cuts{flat_cut(3, 0.7, box_planes({-15, -15, -10}, {30, 30, 25}))};
  const CutResult one = cut_bone(ball, cuts), two = cut_bone(ball, cuts);
  ASSERT_EQ(one.pieces.size(), two.pieces.size());
  for (std::size_t i = 0; i < one.pieces.size(); ++i)
    EXPECT_EQ(mesh_hash(one.pieces[i].mesh), mesh_hash(two.pieces[i].mesh));
}

}  // namespace
}  // namespace condyle
