#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// A point of the surface of a mesh: a node, or a point within a triangle of three nodes.
struct MeshPoint {
  std::array<int, 3> node{};
  std::array<double, 3> weight{};  // sums to 1
  int count = 0;

  Eigen::Vector3d at(const Nodes& x) const {
    Eigen::Vector3d sum = weight[0] * x[node[0]];
    for (int k = 1; k < count; ++k) sum += weight[k] * x[node[k]];
    return sum;
  }
  static MeshPoint of_node(int node) { return {{node}, {1.0}, 1}; }
  static MeshPoint centre(int a, int b, int c) {
    return {{a, b, c}, {1.0 / 3, 1.0 / 3, 1.0 / 3}, 3};
  }
};

/// Appends points distributed evenly over triangles of nodes, between their corners.
void spread(const std::vector<Eigen::Vector3i>& triangles, const Nodes& rest, double spacing_mm,
            std::vector<MeshPoint>& points);

}  // namespace condyle
