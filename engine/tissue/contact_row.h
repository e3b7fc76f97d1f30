#pragma once

#include <Eigen/Core>
#include <array>

#include "engine/minimize/objective.h"

namespace condyle {

/// A one-sided spring: a point that some nodes carry may slide on, and leave, but not pass a plane;
/// or a point of one surface, and one of another, may not pass each other (then the weights sum to
/// 0). Energy: stiffness * min(0, gap)^2 with gap = normal . sum_i weight_i x_i - offset, mm.
struct ContactRow {
  static constexpr int capacity = 6;
  std::array<int, capacity> node{};
  std::array<double, capacity> weight{};
  int count = 0;  // of nodes; those with weights of one sign are neighbours in the net
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of what must not be entered
  double offset = 0;                                  // mm
  double stiffness = 0;                               // N/mm

  /// How far `x` moves along the normal; its gap is this at the nodes' places, less the offset.
  double along(const Points& x) const {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += weight[k] * normal.dot(x[node[k]]);
    return sum;
  }
  double gap(const Points& x) const { return along(x) - offset; }

  static ContactRow of_node(int node, const Eigen::Vector3d& normal, double offset,
                            double stiffness) {
    return {{node}, {1.0}, 1, normal, offset, stiffness};
  }
};

}  // namespace condyle
