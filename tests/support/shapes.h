#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle::test {

/// Closed sphere of 20 * 4^level triangles with all vertices on it; `bumps` presses it in and out
/// by that fraction of the radius.
inline TriMesh sphere(int level, double radius, const Eigen::Vector3d& center = {0, 0, 0},
                      double bumps = 0) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int i, int j) {
      const auto [it, made] =
          middles.try_emplace(std::minmax(i, j), static_cast<int>(mesh.vertices.size()));
      if (made) mesh.vertices.push_back((mesh.vertices[i] + mesh.vertices[j]).normalized());
      return it->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (auto& v : mesh.vertices) v.normalize();
    for (const auto& t : mesh.triangles) {
      const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
    }
    mesh.triangles = finer;
  }
  for (auto& v : mesh.vertices) {
    v.normalize();
    const double wave = std::sin(5 * v.x() + 1) * std::sin(4 * v.y()) + std::cos(6 * v.z());
    v = center + radius * (1 + bumps * wave) * v;
  }
  return mesh;
}

/// Any pose: rotation uniform, translation within +-reach.
inline Pose any_pose(std::mt19937_64& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> along(-reach, reach);
  Pose pose;
  pose.R = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
               .normalized();
  pose.t = {along(random), along(random), along(random)};
  return pose;
}

inline TriMesh moved(TriMesh mesh, const Pose& pose) {
  for (auto& v : mesh.vertices) v = pose * v;
  return mesh;
}

inline TriMesh joined(TriMesh a, const TriMesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back(t + Eigen::Vector3i::Constant(first));
  return a;
}

}  // namespace condyle::test
