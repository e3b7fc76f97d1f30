// Known poses are found again, from points and from surfaces, open ones too.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/mesh/measure.h"
#include "engine/registration/best_fit.h"
#include "engine/registration/rigid_fit.h"
#include "engine/registration/surface_fit.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Pose pose_of(double deg, const Vector3d& axis, const Vector3d& t) {
  Pose pose;
  pose.R = Eigen::AngleAxisd(deg * M_PI / 180, axis.normalized());
  pose.t = t;
  return pose;
}

/// z over a square of 100 mm without any symmetry, facing up; open at its sides.
TriMesh hills(int count = 60) {
  TriMesh mesh;
  for (int i = 0; i <= count; ++i)
    for (int j = 0; j <= count; ++j) {
      const double x = 100.0 * i / count - 50, y = 100.0 * j / count - 50;
      mesh.vertices.emplace_back(
          x, y, 6 * std::sin(x / 11) + 5 * std::cos(y / 9 + 0.4) + 0.004 * x * y - 0.003 * x * x);
    }
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      const int a = i * (count + 1) + j, b = a + count + 1;
      mesh.triangles.emplace_back(a, b, a + 1);
      mesh.triangles.emplace_back(a + 1, b, b + 1);
    }
  return mesh;
}

/// Points of the middle of a mesh, under a pose, with their normals.
struct Points {
  std::vector<Vector3d> points, normals;
};
Points middle_of(const TriMesh& mesh, const Pose& X) {
  Points found;
  const auto normals = vertex_normals(mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3d& p = mesh.vertices[i];
    if (std::abs(p.x()) > 35 || std::abs(p.y()) > 35) continue;
    found.points.push_back(X * p);
    found.normals.push_back(X.R * normals[i]);
  }
  return found;
}

}  // namespace

TEST(RigidFit, FindsThePoseAndIgnoresNoise) {
  const Pose X = pose_of(130, {1, -2, 0.5}, {40, -300, 7});
  std::vector<Vector3d> a = {{0, 0, 0}, {10, 0, 0}, {0, 20, 0}, {3, 4, 30}}, b;
  for (const Vector3d& p : a) b.push_back(X * p);
  const auto fit = rigid_fit(a, b);
  ASSERT_TRUE(fit);
  EXPECT_LT(rotation_angle(fit->inverse() * X), 1e-7);
  EXPECT_LT((fit->t - X.t).norm(), 1e-10);
}

TEST(RigidFit, NeverMirrorsAndRefusesALine) {
  const std::vector<Vector3d> a = {{0, 0, 0}, {10, 0, 0}, {0, 20, 0}, {0, 0, 5}};
  std::vector<Vector3d> mirrored;
  for (const Vector3d& p : a) mirrored.emplace_back(-p.x(), p.y(), p.z());
  const auto fit = rigid_fit(a, mirrored);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->R.toRotationMatrix().determinant(), 1, 1e-12);
  const std::vector<Vector3d> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  EXPECT_FALSE(rigid_fit(line, line));
  EXPECT_FALSE(rigid_fit(std::span(a).first(2), std::span(a).first(2)));
}

TEST(SurfaceFit, FindsThePoseOfASurfaceTheSameForAnyThreads) {
  const TriMesh surface = hills();
  const SurfacePairs pairs(surface);
  const Pose X_AB = pose_of(6, {0.3, 1, -0.4}, {3, -2, 4});
  const Points points = middle_of(surface, X_AB);
  const SurfaceFit fit = fit_to_surface(points.points, points.normals, pairs, {}, {.threads = 1});
  ASSERT_TRUE(fit.converged);
  EXPECT_LT(fit.rms_mm, 1e-6);
  for (const Vector3d& p : points.points)
    ASSERT_LT((fit.X_BA * p - X_AB.inverse() * p).norm(), 1e-5);
  const SurfaceFit again = fit_to_surface(points.points, points.normals, pairs, {}, {.threads = 3});
  EXPECT_EQ(again.X_BA.t, fit.X_BA.t);
  EXPECT_EQ(again.X_BA.R.coeffs(), fit.X_BA.R.coeffs());
}

TEST(SurfaceFit, ATenthOfChangedPointsDoesNotMatter) {
  const TriMesh surface = hills();
  const SurfacePairs pairs(surface);
  Points points = middle_of(surface, pose_of(2, {1, 0, 0}, {1, 1, -2}));
  const auto whole = points.points;
  for (std::size_t i = 0; i < points.points.size() / 12; ++i)
    points.points[i] += 4 * points.normals[i];
  const SurfaceFit fit = fit_to_surface(points.points, points.normals, pairs);
  ASSERT_TRUE(fit.converged);
  const Pose X_BA = pose_of(2, {1, 0, 0}, {1, 1, -2}).inverse();
  for (const Vector3d& p : whole) ASSERT_LT((fit.X_BA * p - X_BA * p).norm(), 0.02);
}

TEST(SurfaceFit, WithoutPartnersNothingIsFitted) {
  const TriMesh surface = hills();
  const SurfacePairs pairs(surface);
  Points points = middle_of(surface, {});
  for (Vector3d& p : points.points) p.x() += 500;  // all nearest points lie on the rim
  const SurfaceFit fit = fit_to_surface(points.points, points.normals, pairs);
  EXPECT_FALSE(fit.converged);
  EXPECT_EQ(fit.pairs, 0);
}

TEST(BestFit, FindsAPoseFarFromEveryStartButOne) {
  const TriMesh surface = hills();
  const SurfacePairs pairs(surface);
  const Pose X_AB = pose_of(75, {0, 0.1, 1}, {30, -20, 4});
  const Points middle = middle_of(surface, X_AB);
  const OrientedPoints points{middle.points, middle.normals};
  EXPECT_EQ(points.thinned(100).size(), 100u);
  std::vector<Pose> starts;
  for (int deg = 0; deg < 360; deg += 20) {
    Pose turn = pose_of(deg, {0, 0, 1}, {0, 0, 0});
    turn.t = -(turn.R * X_AB.t);
    starts.push_back(turn);
  }
  const auto ranked = rank_starts(points, pairs, starts);
  ASSERT_FALSE(ranked.empty());
  const BestFit best = best_fit_to_surface(points, pairs, ranked.front().X_BA);
  EXPECT_LT(best.residual.trimmed_mean_mm, 1e-3);
  EXPECT_EQ(best.residual.without_partner, 0);
  for (const Vector3d& p : points.points)
    ASSERT_LT((best.fit.X_BA * p - X_AB.inverse() * p).norm(), 1e-3);
  BestFitSettings one;
  one.fit.threads = 1;
  const BestFit again = best_fit_to_surface(points, pairs, ranked.front().X_BA, one);
  EXPECT_EQ(again.fit.X_BA.t, best.fit.X_BA.t);
  EXPECT_EQ(rank_starts(points, pairs, starts, one).front().X_BA.t, ranked.front().X_BA.t);
}

TEST(BestFit, PlanesOfExactPointsSurviveANoisySurface) {
  TriMesh surface = hills();
  Points points = middle_of(surface, pose_of(4, {0.3, 1, -0.4}, {2, -2, 3}));
  unsigned state = 1;
  for (auto& v : surface.vertices) {
    state = 1664525u * state + 1013904223u;
    v.z() += 3.0 * (state / 4294967296.0 - 0.5);
  }
  SurfaceFitSettings settings;
  settings.planes_of_points = true;
  settings.least_cos = 0.2;
  const SurfaceFit fit =
      fit_to_surface(points.points, points.normals, SurfacePairs(surface), {}, settings);
  const Pose X_BA = pose_of(4, {0.3, 1, -0.4}, {2, -2, 3}).inverse();
  double largest = 0;
  for (const Vector3d& p : points.points)
    largest = std::max(largest, (fit.X_BA * p - X_BA * p).norm());
  EXPECT_LT(largest, 0.4);  // noise of 0.9 mm on 1800 points
}

TEST(SurfacePairs, SignSideAndRim) {
  const TriMesh surface = hills();
  const SurfacePairs pairs(surface);
  const auto normals = vertex_normals(surface);
  const std::size_t middle = 30 * 61 + 30;
  const Vector3d p = surface.vertices[middle], n = normals[middle];
  const auto front = pairs.find(p + 0.5 * n, n), behind = pairs.find(p - 0.5 * n, n);
  ASSERT_TRUE(front && behind);
  EXPECT_NEAR(front->distance, 0.5, 0.01);
  EXPECT_NEAR(behind->distance, -0.5, 0.01);
  EXPECT_FALSE(pairs.find(p + 0.5 * n, -n)) << "a surface that faces the other way";
  EXPECT_FALSE(pairs.find(Vector3d(60, 0, 0), Vector3d::UnitZ())) << "beyond the rim";
  EXPECT_FALSE(pairs.find(Vector3d(60, 60, 0), Vector3d::UnitZ())) << "beyond a corner";
}

}  // namespace condyle
