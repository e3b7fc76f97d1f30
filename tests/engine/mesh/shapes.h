#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "engine/mesh/tri_mesh.h"

namespace condyle::test {

/// Closed, outward sphere of 20 * 4^rounds triangles.
inline TriMesh sphere(double radius, int rounds, const Eigen::Vector3d& center = {0, 0, 0}) {
  const double g = std::numbers::phi;
  TriMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int r = 0; r < rounds; ++r) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return at->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const auto& t : mesh.triangles) {
      const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      for (const auto& n : {Eigen::Vector3i{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}})
        finer.push_back(n);
    }
    mesh.triangles = finer;
  }
  for (auto& v : mesh.vertices) v = center + radius * v.normalized();
  return mesh;
}

/// Closed, outward box of 12 triangles.
inline TriMesh cuboid(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(),
                               (i & 4) ? high.z() : low.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline Eigen::Affine3d arbitrary_pose(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Affine3d pose = Eigen::Affine3d::Identity();
  pose.translate(Eigen::Vector3d(30 * normal(random), 30 * normal(random), 30 * normal(random)));
  pose.rotate(Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                  .normalized());
  return pose;
}

inline TriMesh moved(TriMesh mesh, const Eigen::Affine3d& pose) {
  for (auto& v : mesh.vertices) v = pose * v;
  return mesh;
}

inline TriMesh joined(TriMesh a, const TriMesh& b) {
  const int offset = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  return a;
}

/// Every triangle with corners of its own, as STL has them.
inline TriMesh unwelded(const TriMesh& mesh) {
  TriMesh soup;
  for (const auto& t : mesh.triangles) {
    const int n = static_cast<int>(soup.vertices.size());
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(mesh.vertices[t[k]]);
    soup.triangles.emplace_back(n, n + 1, n + 2);
  }
  return soup;
}

}  // namespace condyle::test
