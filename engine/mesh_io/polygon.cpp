#include "engine/mesh_io/polygon.h"

#include <Eigen/Geometry>

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool in_triangle(const Vector2d& p, const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0;
}

void cut_quad(std::span<const int> q, const std::vector<Vector3d>& vertices,
              std::vector<Eigen::Vector3i>& triangles) {
  const Vector3d &a = vertices[q[0]], &b = vertices[q[1]], &c = vertices[q[2]], &d = vertices[q[3]];
  // A diagonal is valid if its two triangles face the same side; the shorter of two valid ones.
  const bool ac_sound = (b - a).cross(c - a).dot((c - a).cross(d - a)) > 0;
  const bool bd_sound = (c - b).cross(d - b).dot((d - b).cross(a - b)) > 0;
  const bool along_bd = bd_sound && (!ac_sound || (d - b).squaredNorm() < (c - a).squaredNorm());
  if (along_bd) {
    triangles.emplace_back(q[0], q[1], q[3]);
    triangles.emplace_back(q[1], q[2], q[3]);
  } else {
    triangles.emplace_back(q[0], q[1], q[2]);
    triangles.emplace_back(q[0], q[2], q[3]);
  }
}

}  // namespace

void triangulate(std::span<const int> corners, const std::vector<Vector3d>& vertices,
                 std::vector<Eigen::Vector3i>& triangles) {
  const std::size_t n = corners.size();
  if (n == 3) {
    triangles.emplace_back(corners[0], corners[1], corners[2]);
    return;
  }
  if (n == 4) return cut_quad(corners, vertices, triangles);

  // Plane of the mean normal (Newell), with axes such that the polygon runs counter-clockwise.
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i)
    normal += (vertices[corners[i]] - vertices[corners[0]])
                  .cross(vertices[corners[(i + 1) % n]] - vertices[corners[0]]);
  if (!(normal.norm() > 0)) normal = Vector3d::UnitZ();
  normal.normalize();
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vector2d> flat;
  for (const int c : corners) {
    const Vector3d d = vertices[c] - vertices[corners[0]];
    flat.emplace_back(d.dot(u), d.dot(v));
  }

  std::vector<std::size_t> left(n);
  for (std::size_t i = 0; i < n; ++i) left[i] = i;
  std::size_t at = 0, misses = 0, all_misses = 0;
  while (left.size() > 3) {
    const std::size_t m = left.size();
    const std::size_t a = left[(at + m - 1) % m], b = left[at % m], c = left[(at + 1) % m];
    // A full round without an ear: the polygon intersects itself. It is then cut anywhere, as is
    // one that takes too long.
    bool ear = misses >= m || all_misses > 50 * n;
    if (!ear && cross(flat[a], flat[b], flat[c]) > 0) {
      ear = true;
      for (const std::size_t i : left)
        if (i != a && i != b && i != c && in_triangle(flat[i], flat[a], flat[b], flat[c])) {
          ear = false;
          break;
        }
    }
    if (!ear) {
      ++at, ++misses, ++all_misses;
      if (at >= m) at = 0;
      continue;
    }
    triangles.emplace_back(corners[a], corners[b], corners[c]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(at % m));
    if (at >= left.size()) at = 0;
    misses = 0;
  }
  triangles.emplace_back(corners[left[0]], corners[left[1]], corners[left[2]]);
}

}  // namespace condyle
