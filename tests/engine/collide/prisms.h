#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/mesh/topology.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle::test {

/// The surface, which must be a disc facing up, and its copy `thickness` below, joined at the rim.
inline TriMesh extruded(const TriMesh& top, double thickness) {
  TriMesh mesh = top;
  const int count = static_cast<int>(top.vertices.size());
  for (const auto& v : top.vertices)
    mesh.vertices.push_back(v - thickness * Eigen::Vector3d::UnitZ());
  for (const auto& t : top.triangles)
    mesh.triangles.emplace_back(t[0] + count, t[2] + count, t[1] + count);
  const EdgeList list = find_edges(top);
  for (const Edge& edge : list.edges) {
    if (edge.count != 1) continue;
    const bool forward = list.sides[edge.first].forward;
    const int a = forward ? edge.low : edge.high, b = forward ? edge.high : edge.low;
    mesh.triangles.emplace_back(b, a, a + count);
    mesh.triangles.emplace_back(b, a + count, b + count);
  }
  return mesh;
}

/// Outline in x and z, counter-clockwise seen from -y (x to the right, z up), star-shaped about its
/// first corner's neighbours; from -length / 2 to length / 2 along y.
inline TriMesh prism(const std::vector<Eigen::Vector2d>& outline, double length) {
  TriMesh mesh;
  const int n = static_cast<int>(outline.size());
  for (const double y : {-0.5 * length, 0.5 * length})
    for (const auto& p : outline) mesh.vertices.emplace_back(p.x(), y, p.y());
  // Ends by cutting off ears, so that notches are left open.
  const auto turn = [&](int a, int b, int c) {
    const Eigen::Vector2d u = outline[b] - outline[a], v = outline[c] - outline[a];
    return u.x() * v.y() - u.y() * v.x();
  };
  std::vector<int> left(outline.size());
  for (int i = 0; i < n; ++i) left[i] = i;
  while (left.size() > 2)
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::size_t m = left.size();
      const int a = left[(i + m - 1) % m], b = left[i], c = left[(i + 1) % m];
      bool ear = turn(a, b, c) > 0;
      for (const int p : left)
        ear = ear && (p == a || p == b || p == c || turn(a, b, p) < 0 || turn(b, c, p) < 0 ||
                      turn(c, a, p) < 0);
      if (!ear) continue;
      mesh.triangles.emplace_back(a, b, c);
      mesh.triangles.emplace_back(a + n, c + n, b + n);
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.triangles.emplace_back(j, i, i + n);
    mesh.triangles.emplace_back(j, i + n, j + n);
  }
  return mesh;
}

/// Cylinder along y of that length with half balls at its ends; `around` sides. All vertices lie on
/// the capsule.
inline TriMesh capsule(double radius, double length, int around) {
  TriMesh mesh;
  const int rings = around / 4;  // of each half ball
  const double pi = std::numbers::pi;
  mesh.vertices.emplace_back(0, -0.5 * length - radius, 0);
  for (int r = 1; r <= 2 * rings; ++r) {
    const bool far = r > rings;
    const double tilt = 0.5 * pi * (far ? r - 1 : r) / rings - 0.5 * pi;
    for (int i = 0; i < around; ++i) {
      const double turn = 2 * pi * i / around;
      mesh.vertices.emplace_back(radius * std::cos(tilt) * std::cos(turn),
                                 (far ? 0.5 : -0.5) * length + radius * std::sin(tilt),
                                 radius * std::cos(tilt) * std::sin(turn));
    }
  }
  mesh.vertices.emplace_back(0, 0.5 * length + radius, 0);
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around;
    mesh.triangles.emplace_back(0, 1 + i, 1 + next);
    for (int r = 0; r + 1 < 2 * rings; ++r) {
      const int a = 1 + r * around;
      mesh.triangles.emplace_back(a + i, a + around + i, a + next);
      mesh.triangles.emplace_back(a + next, a + around + i, a + around + next);
    }
    const int top = last - around;
    mesh.triangles.emplace_back(last, top + next, top + i);
  }
  return mesh;
}

}  // namespace condyle::test
