#pragma once

#include <Eigen/Core>
#include <array>

namespace condyle {

/// How much of a prism's volume each of its springs stands for: springs between its corners, of
/// weights w (mm^3) and directions n, resist small strains as an isotropic body does,
///
///   sum_s w_s n n n n = V (dd + dd + dd)     (d: the unit tensor; its three pairings)
///
/// so that k_s = mu w_s / (2 l_s^2) has shear modulus mu and Poisson's ratio 1/4, the only one that
/// springs alone can have; the prisms' volumes add the rest. By symmetry one weight for each edge's
/// springs along the sheets (both), one for each edge's two diagonals, and one for the three
/// springs across. It wants triangles that are nearly even: right angles halve the shear along the
/// layer. Layers thinner than 0.6 of an edge, or thicker than 1.2 edges, would ask for springs that
/// push apart as they are stretched. There weights are the nearest above a small share of V: in
/// layers of a third of an edge shear across the layer is half of what it should be; in layers of
/// three edges the thickness is four times as stiff.
struct PrismWeights {
  std::array<double, 3> along{};     // edges 01 12 20: each of the two springs
  std::array<double, 3> diagonal{};  // each of the two springs
  double across = 0;                 // each of the three springs
};

/// Corners as in SpringPrismNet::prisms; volume above zero.
PrismWeights isotropic_weights(const std::array<Eigen::Vector3d, 6>& corners, double volume);

}  // namespace condyle
