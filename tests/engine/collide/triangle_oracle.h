#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle::test {

using Real = long double;
using Point = Eigen::Matrix<Real, 3, 1>;
using Corners = std::array<Point, 3>;

/// Distance of two segments by walking the sides of the unit square of parameters: the inner
/// minimum if there is one, and the four sides, each a clamped quadratic.
inline Real segment_distance2(const Point& p, const Point& p1, const Point& q, const Point& q1) {
  const Point u = p1 - p, v = q1 - q, w = p - q;
  const Real a = u.dot(u), b = u.dot(v), c = v.dot(v), d = u.dot(w), e = v.dot(w);
  Real best = std::numeric_limits<Real>::infinity();
  const auto offer = [&](Real s, Real t) {
    best = std::min(best, (w + s * u - t * v).squaredNorm());
  };
  const auto clamp = [](Real x) { return std::isfinite(x) ? std::clamp<Real>(x, 0, 1) : Real(0); };
  offer(0, clamp(e / c));
  offer(1, clamp((e + b) / c));
  offer(clamp(-d / a), 0);
  offer(clamp((b - d) / a), 1);
  // By cross products: a c - b^2 would lose what long double has to give at 1e-10 rad.
  const Point n = u.cross(v);
  const Real determinant = n.squaredNorm();
  const Real s = v.cross(w).dot(n) / determinant, t = u.cross(w).dot(n) / determinant;
  if (determinant > 0 && s > 0 && s < 1 && t > 0 && t < 1) offer(s, t);
  return best;
}

/// Height and foot by solving for the barycentric coordinates; infinite beside the triangle.
inline Real face_distance2(const Point& p, const Corners& t) {
  const Point u = t[1] - t[0], v = t[2] - t[0], w = p - t[0];
  const Real uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), wu = w.dot(u), wv = w.dot(v);
  const Real determinant = uu * vv - uv * uv;
  if (!(determinant > 0)) return std::numeric_limits<Real>::infinity();
  const Real s = (vv * wu - uv * wv) / determinant, r = (uu * wv - uv * wu) / determinant;
  if (s < 0 || r < 0 || s + r > 1) return std::numeric_limits<Real>::infinity();
  return (w - s * u - r * v).squaredNorm();
}

/// Whether the segment passes through the face: signs of volumes.
inline bool pierces(const Point& p, const Point& q, const Corners& t) {
  const auto volume = [](const Point& a, const Point& b, const Point& c, const Point& d) {
    return (b - a).cross(c - a).dot(d - a);
  };
  const Real above = volume(t[0], t[1], t[2], p), below = volume(t[0], t[1], t[2], q);
  if ((above > 0) == (below > 0)) return false;
  const Real x = volume(p, q, t[0], t[1]), y = volume(p, q, t[1], t[2]),
             z = volume(p, q, t[2], t[0]);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

/// Distance of two triangles in long double, implemented independently of the one under test.
inline Real triangle_distance_oracle(const Corners& a, const Corners& b) {
  Real best = std::numeric_limits<Real>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) return 0;
    best = std::min({best, face_distance2(a[i], b), face_distance2(b[i], a)});
    for (int j = 0; j < 3; ++j)
      best = std::min(best, segment_distance2(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return std::sqrt(best);
}

inline Corners corners_of(const TriMesh& mesh, std::size_t triangle, const Pose& pose) {
  Corners corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = (pose * mesh.vertices[mesh.triangles[triangle][k]]).cast<Real>();
  return corners;
}

/// Smallest distance over all pairs of triangles.
inline double brute_force_distance(const TriMesh& a, const Pose& X_WA, const TriMesh& b,
                                   const Pose& X_WB) {
  std::vector<Corners> triangles_a, triangles_b;
  for (std::size_t i = 0; i < a.triangles.size(); ++i)
    triangles_a.push_back(corners_of(a, i, X_WA));
  for (std::size_t i = 0; i < b.triangles.size(); ++i)
    triangles_b.push_back(corners_of(b, i, X_WB));
  Real best = std::numeric_limits<Real>::infinity();
  for (const auto& ta : triangles_a)
    for (const auto& tb : triangles_b) {
      // Triangles whose bounding balls are farther apart than the best so far are skipped.
      const Point ca = (ta[0] + ta[1] + ta[2]) / 3, cb = (tb[0] + tb[1] + tb[2]) / 3;
      Real ra = 0, rb = 0;
      for (int k = 0; k < 3; ++k)
        ra = std::max(ra, (ta[k] - ca).norm()), rb = std::max(rb, (tb[k] - cb).norm());
      if ((ca - cb).norm() - ra - rb < best)
        best = std::min(best, triangle_distance_oracle(ta, tb));
    }
  return static_cast<double>(best);
}

}  // namespace condyle::test
