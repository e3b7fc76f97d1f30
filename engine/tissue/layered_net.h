#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Material of one layer. Springs and volumes are scaled with the size of the mesh, so that the
/// same numbers mean the same tissue at any resolution.
struct LayerMaterial {
  double modulus_MPa = 0.02;  // Young's modulus of the springs' net
  double bulk_MPa = 0.1;      // resistance to a change of volume
};

/// Node `sheet` (0 outermost) of column `column`.
inline int node_of(int column, int sheet, int sheets) { return column * sheets + sheet; }

/// Edges of a triangle net, each once with its smaller vertex first, in rising order.
std::vector<std::array<int, 2>> edges_of(const std::vector<Eigen::Vector3i>& triangles);

/// Springs and prisms between sheets of the same triangle net. Per edge: one spring on each sheet
/// and both diagonals of each side quad; per column: one spring across each layer.
/// `nodes` has columns * sheets entries in `node_of` order and is the rest state; triangles run
/// counter-clockwise seen from the outermost sheet; one material per layer (sheets - 1).
SpringPrismNet layered_net(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                           const Nodes& nodes, const std::vector<LayerMaterial>& layers);

}  // namespace condyle
