#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// A point embedded in the mesh by a few nodes: x = X + fade * sum_i w_i (x_i - X_i + (A_i - 1)(X -
/// X_i)), with A_i the deformation gradient at node i. At rest it is exactly X.
struct CarriedPoint {
  static constexpr int capacity = 12;
  std::array<int, capacity> handle{};    // index of a handle (see HandleSet)
  std::array<float, capacity> weight{};  // sums to 1; 0 where unused
  float fade = 1;                        // 0 = fixed
};

/// Nodes that carry embedded points, each with neighbours from which its deformation gradient is
/// estimated.
struct HandleSet {
  std::vector<int> node;             // of each handle
  std::vector<int> first_neighbour;  // handle -> range in `neighbour`, one longer than node
  std::vector<int> neighbour;        // nodes
  std::vector<Eigen::Matrix3d> inverse_spread;  // of the rest offsets, per handle
  std::vector<std::vector<int>> ring;           // adjacent handles, to smooth the deformation
};

/// Handles at the outermost nodes of a layered mesh of `sheets` sheets (see layered_mesh.h).
HandleSet make_handles(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                       const Nodes& rest);

/// Displacement and deformation (minus 1) of each handle between the two states.
struct HandleMotion {
  std::vector<Eigen::Vector3d> moved;
  std::vector<Eigen::Matrix3d> stretched;
};
HandleMotion handle_motion(const HandleSet& handles, const Nodes& rest, const Nodes& now);

/// Distance between a point and handle i in the body, mm.
using BodyDistance = std::function<double(int handle)>;

/// Weights that decrease smoothly to zero at the distance of the 12th nearest handle, times
/// `reach_fraction` (above 0).
CarriedPoint carry(const std::vector<int>& candidates, const BodyDistance& distance,
                   double reach_fraction = 1);

/// The displaced position of the point at rest position X. `rest` are the mesh's nodes at rest.
inline Eigen::Vector3d carried(const CarriedPoint& c, const HandleSet& handles, const Nodes& rest,
                               const HandleMotion& motion, const Eigen::Vector3d& X) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < CarriedPoint::capacity; ++k) {
    const int h = c.handle[k];
    sum += static_cast<double>(c.weight[k]) *
           (motion.moved[h] + motion.stretched[h] * (X - rest[handles.node[h]]));
  }
  return X + static_cast<double>(c.fade) * sum;
}

}  // namespace condyle
