#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "engine/mesh/tri_mesh.h"
#include "tests/support/shapes.h"

namespace condyle::test {

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
