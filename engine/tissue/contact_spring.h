#pragma once

#include <Eigen/Core>
#include <array>

#include "engine/minimize/objective.h"

namespace condyle {

/// A one-sided spring: a point interpolated between nodes may slide along and leave a plane but not
/// pass it; or points of two surfaces may not pass each other (the weights then sum to 0). Energy:
/// stiffness * min(0, gap)^2 with gap = normal . sum_i weight_i x_i - offset, mm.
struct ContactSpring {
  static constexpr int capacity = 6;
  std::array<int, capacity> node{};
  std::array<double, capacity> weight{};
  int count = 0;  // of nodes; those with weights of equal sign are neighbours in the mesh
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the obstacle
  double offset = 0;                                  // mm
  double stiffness = 0;                               // N/mm

  /// Position along the normal; for a displacement x, the displacement along the normal.
  double along(const Points& x) const {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += weight[k] * normal.dot(x[node[k]]);
    return sum;
  }
  double gap(const Points& x) const { return along(x) - offset; }

  static ContactSpring of_node(int node, const Eigen::Vector3d& normal, double offset,
                               double stiffness) {
    return {{node}, {1.0}, 1, normal, offset, stiffness};
  }
};

}  // namespace condyle
