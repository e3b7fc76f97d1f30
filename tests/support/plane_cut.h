#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle::test {

/// A closed mesh parted by a plane: both halves are closed by caps in the plane, and no bone is
/// lost between them.
struct PlaneCut {
  TriMesh below, above;             // by the side of the plane, its normal pointing above
  std::vector<char> is_below = {};  // of each triangle of the mesh, by its middle
};

namespace plane_cut {

using Eigen::Vector2d;
using Eigen::Vector3d;

inline double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Triangles that fill a flat polygon, counter-clockwise or clockwise as it runs: ears are cut off.
inline std::vector<std::array<int, 3>> ears(std::vector<int> loop,
                                            const std::vector<Vector2d>& at) {
  double area = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    area += turn(at[loop[0]], at[loop[i]], at[loop[i + 1]]);
  const double sign = area < 0 ? -1 : 1;
  std::vector<std::array<int, 3>> triangles;
  while (loop.size() > 3) {
    std::size_t best = 0;
    double best_turn = -1e300;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int a = loop[(i + loop.size() - 1) % loop.size()], b = loop[i],
                c = loop[(i + 1) % loop.size()];
      const double here = sign * turn(at[a], at[b], at[c]);
      bool holds_other = here <= 0;
      for (std::size_t k = 0; k < loop.size() && !holds_other; ++k) {
        const int p = loop[k];
        holds_other = p != a && p != b && p != c && sign * turn(at[a], at[b], at[p]) >= 0 &&
                      sign * turn(at[b], at[c], at[p]) >= 0 &&
                      sign * turn(at[c], at[a], at[p]) >= 0;
      }
      // Flat corners as a last resort only: an ear of no area is better than a crossing one.
      const double worth = holds_other ? here - 1e6 : here;
      if (worth > best_turn) {
        best_turn = worth;
        best = i;
      }
    }
    triangles.push_back(
        {loop[(best + loop.size() - 1) % loop.size()], loop[best], loop[(best + 1) % loop.size()]});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({loop[0], loop[1], loop[2]});
  return triangles;
}

/// The half of a closed mesh where `height` is positive, with its cap.
inline TriMesh half(const TriMesh& mesh, const std::vector<double>& height,
                    const Vector3d& normal) {
  TriMesh made;
  std::vector<int> kept(mesh.vertices.size(), -1);
  std::map<std::pair<int, int>, int> crossing;
  const auto vertex = [&](int v) {
    if (kept[v] < 0) {
      kept[v] = static_cast<int>(made.vertices.size());
      made.vertices.push_back(mesh.vertices[v]);
    }
    return kept[v];
  };
  const auto cross = [&](int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    const auto [at, fresh] =
        crossing.try_emplace({low, high}, static_cast<int>(made.vertices.size()));
    if (fresh) {
      const double s = height[low] / (height[low] - height[high]);
      made.vertices.push_back(mesh.vertices[low] + s * (mesh.vertices[high] - mesh.vertices[low]));
    }
    return at->second;
  };
  std::map<int, int> next;  // along the rims, as the cap's edges run
  for (const auto& t : mesh.triangles) {
    std::vector<int> corners;
    int leaves = -1, enters = -1;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (height[a] > 0) corners.push_back(vertex(a));
      if ((height[a] > 0) == (height[b] > 0)) continue;
      corners.push_back(cross(a, b));
      (height[a] > 0 ? leaves : enters) = corners.back();
    }
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
      made.triangles.emplace_back(corners[0], corners[i], corners[i + 1]);
    if (leaves >= 0) next[enters] = leaves;
  }
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vector2d> flat;
  for (const auto& p : made.vertices) flat.emplace_back(u.dot(p), v.dot(p));
  while (!next.empty()) {
    std::vector<int> loop;
    for (auto at = next.begin(); at != next.end(); at = next.find(loop.back())) {
      loop.push_back(at->second);
      next.erase(at);
    }
    for (const auto& [p, q, r] : ears(loop, flat)) made.triangles.emplace_back(p, q, r);
  }
  return made;
}

}  // namespace plane_cut

/// `normal` (unit) points above; the mesh must be closed and welded.
inline PlaneCut cut_by_plane(const TriMesh& mesh, const Eigen::Vector3d& point,
                             const Eigen::Vector3d& normal) {
  std::vector<double> height, depth;
  for (const auto& p : mesh.vertices) {
    height.push_back(normal.dot(p - point));
    if (height.back() == 0) height.back() = 1e-9;
    depth.push_back(-height.back());
  }
  PlaneCut cut{plane_cut::half(mesh, depth, normal), plane_cut::half(mesh, height, normal)};
  for (const auto& t : mesh.triangles)
    cut.is_below.push_back(height[t[0]] + height[t[1]] + height[t[2]] < 0);
  return cut;
}

}  // namespace condyle::test
