#pragma once

#include <Eigen/Core>
#include <array>

namespace condyle {

/// Of a spring, over the volume V of its prism: see PrismWeights.
constexpr double least_spring_weight = 0.2;

/// The volume of a prism that each of its springs represents: springs between its corners, with
/// weights w (mm^3) and directions n, respond to small strains as an isotropic body,
///
///   sum_s w_s n n n n = V (dd + dd + dd)     (d: the unit tensor; its three pairings)
///
/// so that k_s = mu w_s / (2 l_s^2) has shear modulus mu and Poisson's ratio 1/4, the only value
/// that springs alone can have; the volume energy of the prisms adds the remaining bulk stiffness.
/// By symmetry one weight for each edge's springs along the sheets (both), one for each edge's two
/// diagonals, and one for the three springs across. Precondition: nearly equilateral triangles;
/// right angles halve the shear stiffness along the layer. Layers thinner than 0.6 of an edge, or
/// thicker than 1.2 edges, would require negative stiffness. The weights are then the nearest ones
/// above a small fraction of V: in layers of a third of an edge, shear across the layer is half of
/// the exact value, which shear_springs.h makes up for; in layers of three edges the thickness is
/// four times too stiff.
struct PrismWeights {
  std::array<double, 3> along{};     // edges 01 12 20: each of the two springs
  std::array<double, 3> diagonal{};  // each of the two springs
  double across = 0;                 // each of the three springs
};

/// Unit direction across a prism, outward, from the mean of its upper and lower triangle.
Eigen::Vector3d across_prism(const std::array<Eigen::Vector3d, 6>& corners);

/// Corners as in SpringPrismMesh::prisms; volume above zero.
PrismWeights isotropic_weights(const std::array<Eigen::Vector3d, 6>& corners, double volume);

}  // namespace condyle
