// The distance field of a piece, taken from that of the uncut mesh where the cut changed nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <random>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/cut/cut.h"
#include "engine/mesh/tri_mesh.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/support/builtin.h"
#include "tests/support/program.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const FieldSettings settings{.spacing_mm = 0.5, .band_mm = 2, .region = {}};

/// Both surfaces in one mesh.
TriMesh together(TriMesh mesh, const TriMesh& other) {
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back(t.array() + first);
  return mesh;
}

/// Samples and hash of a piece's field must be those of one without anything to copy.
void expect_same_field(const TriMesh& piece, const TriMesh& uncut, const DistanceField& of_uncut) {
  TriMesh elsewhere = uncut;
  for (auto& vertex : elsewhere.vertices) vertex += Vector3d(500, 0, 0);
  const DistanceField computed(piece, elsewhere, of_uncut, 2);
  EXPECT_GT(computed.brick_count(), 100U);
  for (const int threads : {1, 2})
    EXPECT_EQ(DistanceField(piece, uncut, of_uncut, threads).hash(), computed.hash()) << threads;
}

/// Within 4 mm of a point the field has the distances of the piece, but for the error of
/// interpolation at edges.
void expect_distances_of(const TriMesh& piece, const DistanceField& field, const Vector3d& at) {
  const TriangleTree tree(piece);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> shift(-4, 4);
  int known = 0;
  double sum = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d p = at + Vector3d(shift(random), shift(random), shift(random));
    const FieldSample sample = field.at(p);
    if (!sample.known) continue;
    ++known;
    sum += std::abs(sample.distance_mm - tree.signed_distance(p));
  }
  EXPECT_GT(known, 400);
  EXPECT_LT(sum / known, 0.01);
}

TEST(PieceField, OfACutBallIsThatOfThePieceAlone) {
  const TriMesh ball = test::sphere(5, 20);
  const DistanceField whole(ball, settings, 2);
  const std::vector<Cut> cuts{{"flat", Region::above({Vector3d::UnitZ(), 5}, 3), {}, 0.5}};
  const CutResult result = cut_bone(ball, cuts);
  ASSERT_EQ(result.pieces.size(), 2U);
  for (const Piece& piece : result.pieces) {
    expect_same_field(piece.mesh, ball, whole);
    expect_distances_of(piece.mesh, DistanceField(piece.mesh, ball, whole, 2), {19, 0, 5});
    expect_distances_of(piece.mesh, DistanceField(piece.mesh, ball, whole, 2), {0, 0, 5});
  }
}

TEST(PieceField, OverlappingShellsThatThePieceLacksAreNotCopied) {
  // A root that crosses the cut stays with the upper piece: within it the lower piece has values of
  // its own.
  const TriMesh ball = test::sphere(4, 20);
  const TriMesh root = test::sphere(3, 6, {0, 0, 4});
  const TriMesh both = together(ball, root);
  const DistanceField whole(both, settings, 2);
  const std::vector<Cut> cuts{{"flat", Region::above({Vector3d::UnitZ(), 1}, 3), {}, 0}};
  const CutResult result = cut_bone(ball, cuts);
  ASSERT_EQ(result.pieces.size(), 2U);
  expect_same_field(together(result.pieces[0].mesh, root), both, whole);
  expect_same_field(result.pieces[0].mesh, both, whole);
  expect_same_field(result.pieces[1].mesh, both, whole);
}

TEST(PieceField, OfAJawWithItsTeethIsThatOfThePieceAlone) {
  const Case& patient = test::builtin();
  TriMesh teeth;
  for (const Part& part : patient.parts)
    if (part.role == Role::lower_teeth) teeth = together(std::move(teeth), part.mesh);
  const TriMesh& bone = patient.find(Role::mandible)->mesh;
  const TriMesh jaw = together(bone, teeth);
  const DistanceField whole(jaw, settings, 2);
  const Vector3d& foramen = patient.landmarks.points.at("left_mental_foramen");
  const std::vector<Cut> cuts{
      {"body", Region::above({Vector3d::UnitX(), foramen.x() + 4}, 3), {}, 0.5}};
  const CutResult result = cut_bone(bone, cuts);
  ASSERT_GE(result.pieces.size(), 2U);
  for (const Piece& piece : result.pieces) expect_same_field(piece.mesh, jaw, whole);
  expect_same_field(together(result.pieces[0].mesh, teeth), jaw, whole);
}

TEST(PieceField, IsReadFromTheCacheWithTheSameBits) {
  const TriMesh ball = test::sphere(4, 20);
  const DistanceField whole(ball, settings, 2);
  const std::vector<Cut> cuts{{"flat", Region::above({Vector3d::UnitZ(), 5}, 3), {}, 0.5}};
  const TriMesh piece = cut_bone(ball, cuts).pieces[0].mesh;
  const test::Folder cache;
  const auto made = cached_piece_field(cache.path(), piece, ball, whole);
  const auto read = cached_piece_field(cache.path(), piece, ball, whole);
  EXPECT_EQ(made.hash(), DistanceField(piece, ball, whole).hash());
  EXPECT_EQ(made.hash(), read.hash());
  // On another grid it is another field.
  const DistanceField smaller(ball, {.spacing_mm = 0.5, .band_mm = 1, .region = {}});
  EXPECT_NE(cached_piece_field(cache.path(), piece, ball, smaller).hash(), made.hash());
  const auto files = std::filesystem::directory_iterator(cache.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 2);
}

TEST(PieceField, OfAnOpenSurfaceIsComputed) {
  TriMesh ball = test::sphere(4, 20);
  const DistanceField of_ball(ball, settings, 2);
  ball.triangles.resize(ball.triangles.size() - 40);
  expect_same_field(ball, test::sphere(4, 20), of_ball);
}

}  // namespace
}  // namespace condyle
