#include "engine/collide/distance_field.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <random>

#include "engine/collide/solid.h"
#include "engine/core/files.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

Vector3d any_point(std::mt19937_64& random, const Box& box) {
  std::uniform_real_distribution<double> u(0, 1);
  return box.low + Vector3d(u(random), u(random), u(random)).cwiseProduct(box.size());
}

TEST(DistanceField, OfASphereHasItsDistanceAndNormal) {
  const Vector3d center(1.3, -2.1, 0.7);
  const DistanceField field(test::sphere(5, 9, center), {}, 2);
  std::mt19937_64 random(1);
  int seen = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vector3d direction = test::any_pose(random, 1).R * Vector3d::UnitX();
    const double distance = std::uniform_real_distribution<double>(-0.6, 0.6)(random);
    const FieldSample sample = field.at(center + (9 + distance) * direction);
    ASSERT_TRUE(sample.known);
    ++seen;
    EXPECT_NEAR(sample.distance_mm, distance, 0.01);
    const double degrees = std::acos(std::min(1.0, sample.gradient.normalized().dot(direction))) *
                           180 / std::numbers::pi;
    EXPECT_LE(degrees, 1.5);  // the facets are half a degree off themselves
    EXPECT_NEAR(sample.gradient.norm(), 1, 0.03);
  }
  EXPECT_EQ(seen, 20000);
}

TEST(DistanceField, IsTheExactDistanceOfTheMesh) {
  const TriMesh mesh = test::sphere(4, 9, {0, 0, 0}, 0.06);
  const DistanceField field(mesh, {}, 2);
  const TriangleTree tree(mesh);
  std::mt19937_64 random(2);
  Box box = bounding_box(mesh);
  int near = 0, far = 0;
  double sum = 0;
  for (int k = 0; k < 40000; ++k) {
    const Vector3d p = any_point(random, box);
    const double exact = tree.signed_distance(p);
    EXPECT_LE(field.lower_bound(p), exact < -1 ? 0.0 : exact + 1e-6);
    const FieldSample sample = field.at(p);
    if (std::abs(exact) < 0.5) {
      ++near;
      ASSERT_TRUE(sample.known);
      sum += std::abs(sample.distance_mm - exact);
      EXPECT_NEAR(sample.distance_mm, exact, 0.03);  // creases between facets
    } else {
      ++far;
      EXPECT_EQ(sample.distance_mm > 0, exact > 0);
    }
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(far, 1000);
  EXPECT_LE(sum / near, 0.003);
}

/// A triangle divided at a point just inside of one edge: the triangle at that edge is a sliver.
TriMesh with_sliver(TriMesh mesh, int triangle) {
  const Eigen::Vector3i t = mesh.triangles[triangle];
  const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const Vector3d middle = 0.5 * (a + b), inside = middle + 1e-7 * (c - middle);
  const int m = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(inside);
  mesh.triangles[triangle] = {t[0], t[1], m};
  mesh.triangles.emplace_back(t[1], t[2], m);
  mesh.triangles.emplace_back(t[2], t[0], m);
  return mesh;
}

TEST(DistanceField, SliversHideNoOtherFace) {
  const TriMesh plain = test::sphere(3, 9);
  TriMesh mesh = plain;
  for (int t = 0; t < static_cast<int>(plain.triangles.size()); t += 3) mesh = with_sliver(mesh, t);
  const DistanceField field(mesh, {}, 2), without(plain, {}, 2);
  std::mt19937_64 random(4);
  const Box box = bounding_box(plain);
  int near = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vector3d p = any_point(random, box);
    const FieldSample sample = field.at(p), expected = without.at(p);
    ASSERT_EQ(sample.known, expected.known);
    if (!sample.known) continue;
    ++near;
    EXPECT_NEAR(sample.distance_mm, expected.distance_mm, 1e-5);
  }
  EXPECT_GT(near, 1000);
}

TEST(DistanceField, GradientIsTheSlopeOfTheDistance) {
  const DistanceField field(test::sphere(3, 6, {0, 0, 0}, 0.1), {});
  std::mt19937_64 random(3);
  int compared = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vector3d p = any_point(random, {Vector3d::Constant(-6), Vector3d::Constant(6)});
    const FieldSample here = field.at(p);
    if (!here.known) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = 1e-6 * Vector3d::Unit(axis);
      const FieldSample up = field.at(p + step), down = field.at(p - step);
      if (!up.known || !down.known) continue;
      const double slope = (up.distance_mm - down.distance_mm) / 2e-6;
      if (std::abs(slope - here.gradient[axis]) < 1e-4) ++compared;  // else p lies at a cell's wall
    }
  }
  EXPECT_GT(compared, 2000);
}

TEST(DistanceField, BoxIsExactOffItsEdgesAndCountsInsideBeyondTheBand) {
  const DistanceField field(test::box({-9, -8, -7}, {9, 8, 7}), {});
  EXPECT_NEAR(field.at({0, 0, 7.5}).distance_mm, 0.5, 1e-5);
  EXPECT_NEAR(field.at({1, 2, 6.4}).distance_mm, -0.6, 1e-5);
  EXPECT_NEAR(field.at({8.3, 0.2, 0}).distance_mm, -0.7, 1e-5);
  EXPECT_LT((field.at({0, 0, 7.5}).gradient - Vector3d::UnitZ()).norm(), 1e-4);
  EXPECT_FALSE(field.at({0, 0, 0}).known);
  EXPECT_LT(field.at({0, 0, 0}).distance_mm, 0);
  EXPECT_FALSE(field.at({50, 0, 0}).known);
  EXPECT_GT(field.at({50, 0, 0}).distance_mm, 0);
  EXPECT_NEAR(field.lower_bound({55, 0, 0}), 45, 2);
}

TEST(DistanceField, OverlappingShellsAreTheirUnionAndCavitiesAreFilled) {
  const TriMesh pair =
      test::joined(test::box({0, 0, 0}, {6, 6, 6}), test::box({4.7, 0, 0}, {10, 6, 6}));
  const DistanceField both(pair, {});
  EXPECT_NEAR(both.at({5.35, 3, 5.5}).distance_mm, -0.5, 1e-4);
  EXPECT_LT(both.at({5.3, 3, 3}).distance_mm, -0.6);
  TriMesh inner = test::sphere(3, 3);
  for (auto& t : inner.triangles) std::swap(t[1], t[2]);
  const DistanceField hollow(test::joined(test::sphere(3, 6), inner), {});
  EXPECT_LT(hollow.at({3.2, 0, 0}).distance_mm, 0);
  EXPECT_LT(hollow.at({2.5, 0, 0}).distance_mm, 0);
  EXPECT_NEAR(DistanceField(inner, {}).at({2.5, 0, 0}).distance_mm, -0.5, 0.06);  // turned
}

TEST(DistanceField, AnOpenSheetIsSolidBehindItsFacesButNotPastItsRim) {
  TriMesh sheet;  // 10 x 10 mm in the plane z = 0, facing up
  for (int y = 0; y <= 10; ++y)
    for (int x = 0; x <= 10; ++x) sheet.vertices.emplace_back(x, y, 0);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) {
      const int i = x + 11 * y;
      sheet.triangles.push_back({i, i + 1, i + 12});
      sheet.triangles.push_back({i, i + 12, i + 11});
    }
  const DistanceField field(sheet, {});
  EXPECT_NEAR(field.at({5, 5, 0.6}).distance_mm, 0.6, 1e-4);
  EXPECT_NEAR(field.at({5, 5, -0.6}).distance_mm, -0.6, 1e-4);
  EXPECT_GT(field.at({5, 5, -3}).distance_mm, 0);  // far behind: no inside
  EXPECT_NEAR(field.at({-0.6, 5, -0.3}).distance_mm, std::hypot(0.6, 0.3), 0.02);
  // Straight below the rim the sign jumps.
  EXPECT_FALSE(field.at({0, 5.1, -0.6}).known);
  for (const double x : {-0.9, -0.4, 0.4, 2.0})
    EXPECT_LE(field.lower_bound({x, 5, -0.5}), -0.5 + 1e-6);
}

TEST(DistanceField, IsBitIdenticalOnOneAndTwoThreads) {
  const TriMesh mesh = test::sphere(4, 8, {0.3, 0.2, 0.1}, 0.08);
  const DistanceField one(mesh, {}, 1), two(mesh, {}, 2);
  EXPECT_EQ(one.hash(), two.hash());
  EXPECT_GT(one.brick_count(), 50u);
}

TEST(DistanceField, RegionKeepsWhatLiesWithin) {
  const TriMesh mesh = test::sphere(4, 8);
  const Box region{{0, -3, -3}, {10, 3, 3}};
  FieldSettings within;
  within.region = region;
  const DistanceField whole(mesh, {}), part(mesh, within);
  EXPECT_LT(part.brick_count(), whole.brick_count() / 2);
  std::mt19937_64 random(4);
  for (int k = 0; k < 2000; ++k) {
    const Vector3d p = any_point(random, region);
    if (std::abs(p.norm() - 8) < 1) {
      EXPECT_NEAR(part.at(p).distance_mm, whole.at(p).distance_mm, 0.03);
    }
    EXPECT_EQ(part.at(p).distance_mm < 0, whole.at(p).distance_mm < 0);
  }
  EXPECT_FALSE(part.at({-8, 0, 0}).known);
  EXPECT_GT(part.lower_bound({-8, 0, 0}), 5);
}

TEST(DistanceField, TurnedMeshHasTheTurnedField) {
  std::mt19937_64 random(5);
  const TriMesh mesh = test::sphere(4, 8, {0, 0, 0}, 0.05);
  const Pose X = test::any_pose(random, 20);
  const DistanceField field(mesh, {}), turned(test::moved(mesh, X), {});
  const TriangleTree tree(mesh);
  int near = 0;
  for (int k = 0; k < 10000; ++k) {
    const Vector3d p = any_point(random, bounding_box(mesh));
    if (std::abs(tree.signed_distance(p)) > 0.5) continue;
    ++near;
    const FieldSample a = field.at(p), b = turned.at(X * p);
    EXPECT_NEAR(a.distance_mm, b.distance_mm, 0.03);
    EXPECT_GT((X.R * a.gradient).normalized().dot(b.gradient.normalized()), 0.97);
  }
  EXPECT_GT(near, 200);
}

class FieldCache : public ::testing::Test {
 protected:
  FieldCache()
      : folder_(fs::temp_directory_path() / ("condyle-field-" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
  }
  ~FieldCache() override { fs::remove_all(folder_); }
  std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder_)) found.push_back(entry.path());
    return found;
  }
  fs::path folder_;
};

TEST_F(FieldCache, RoundTripsBitIdenticallyAndRebuildsDamagedFiles) {
  const TriMesh mesh = test::sphere(3, 5);
  const auto expected = DistanceField(mesh, {}).hash();
  EXPECT_EQ(cached_field(folder_, mesh, {}).hash(), expected);
  ASSERT_EQ(files().size(), 1u);
  const fs::path file = files().front();
  const std::string whole = read_file(file);
  EXPECT_EQ(cached_field(folder_, mesh, {}).hash(), expected);
  for (const std::size_t at :
       {std::size_t{3}, std::size_t{20}, whole.size() / 2, whole.size() - 1}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_file(file, damaged);
    EXPECT_EQ(cached_field(folder_, mesh, {}).hash(), expected);
    EXPECT_EQ(read_file(file), whole) << at;
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{7}, whole.size() / 3}) {
    write_file(file, whole.substr(0, length));
    EXPECT_EQ(cached_field(folder_, mesh, {}).hash(), expected);
    EXPECT_EQ(read_file(file), whole) << length;
  }
  FieldSettings coarser;
  coarser.spacing_mm = 0.3;
  cached_field(folder_, mesh, coarser);
  cached_field(folder_, test::sphere(3, 5.01), {});
  EXPECT_EQ(files().size(), 3u);
}

TEST_F(FieldCache, CancelledWorkStopsAtItsNextReport) {
  struct GivenUp {};
  const TriMesh mesh = test::sphere(4, 12);
  std::vector<double> reported;
  const Progress listen = [&](std::string_view, double fraction) { reported.push_back(fraction); };
  EXPECT_EQ(cached_field(folder_, mesh, {}, 2, listen).hash(), DistanceField(mesh, {}).hash());
  ASSERT_GT(reported.size(), 8u);
  EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end()));
  fs::remove_all(folder_);
  std::size_t calls = 0;
  EXPECT_THROW(cached_field(folder_, mesh, {}, 2,
                            [&](std::string_view, double) {
                              if (++calls == reported.size()) throw GivenUp{};
                            }),
               GivenUp);
  EXPECT_FALSE(fs::exists(folder_)) << "nothing half made is kept";
}

TEST_F(FieldCache, ThatCannotBeWrittenIsNoError) {
  std::ofstream(folder_) << "a file where the folder should be";
  const TriMesh mesh = test::sphere(2, 4);
  EXPECT_EQ(cached_field(folder_, mesh, {}).hash(), DistanceField(mesh, {}).hash());
}

}  // namespace
}  // namespace condyle
