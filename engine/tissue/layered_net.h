#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Material of one layer, as an elastic body's.
struct LayerMaterial {
  double modulus_MPa = 0.02;  // Young's modulus
  double poisson = 0.45;      // above 1/4, which is the springs' own, and below 1/2
  double mass_kg = 0;         // of the whole layer; spread over its nodes by volume
};

/// What prisms add to the springs' resistance to a change of volume, MPa: with mu the shear modulus
/// E / (2 (1 + nu)), mu (4 nu - 1) / (1 - 2 nu). Springs alone have Lame's first constant equal to
/// mu.
double bulk_modulus_of_prisms(const LayerMaterial& layer);

/// Layers from the outermost inward, with the share of the thickness of each.
struct LayerStack {
  std::vector<double> share;
  std::vector<LayerMaterial> material;
  std::vector<int> cut_from = {};  // see split_layers; empty: none is cut
};

/// 1, 2, 3 or 5 layers of facial soft tissue. source: skin and cheek 30 to 40 kPa in vivo, deeper
/// layers softer. throws: InputError for another count.
LayerStack usual_layers(int count);

/// The same layers, each cut into equal ones until none is thicker than 1.2 edges: springs cannot
/// resist evenly in taller prisms (spring_map.h). Masses are shared out; cut_from tells the layer
/// of `layers` that each is of. depth_mm: of the whole stack; edge_mm: of the mesh along it.
LayerStack split_layers(const LayerStack& layers, double depth_mm, double edge_mm);

/// Node `sheet` (0 outermost) of column `column`.
inline int node_of(int column, int sheet, int sheets) { return column * sheets + sheet; }

/// Edges of a triangle net, each once with its smaller vertex first, in rising order.
std::vector<std::array<int, 2>> edges_of(const std::vector<Eigen::Vector3i>& triangles);

/// Springs and prisms between sheets of the same triangle net. Per edge: one spring on each sheet
/// and both diagonals of each side quad; per column: one spring across each layer.
/// `nodes` has columns * sheets entries in `node_of` order and is the rest state; triangles run
/// counter-clockwise seen from the outermost sheet; one material per layer (sheets - 1).
///
/// Spring constants follow from modulus, thickness and mesh size: k = mu A / (2 l), with l the
/// length of the spring and A = w / l the cross-section of tissue that it stands for; w, of the
/// order of the prism's volume, is chosen for each prism so that it resists as an isotropic body
/// (spring_map.h), and summed over the prisms around the spring. So for even prisms of edge l and
/// height h sheet springs go with h, those across with l^2 / h, and diagonals between; the same
/// layers mean the same tissue at any mesh size. Springs that are weaker when shortened get
/// 2 / (1 + compression_share) times as much, for the same mean of both ways in shear.
/// A prism's volume_weight is bulk_modulus_of_prisms / (2 v).
///
/// A sheet between two layers has springs of both; in spring_layer it goes with the one below.
/// throws: InputError for a modulus, Poisson's ratio, mass or compression share out of range.
SpringPrismNet layered_net(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                           const Nodes& nodes, const std::vector<LayerMaterial>& layers,
                           double compression_share = 0.05);

/// Turns a layered net into equation (1) as it is printed: one spring constant for each layer's
/// class, volumes in mm^3 against lengths in mm, springs that push as they pull and no barrier
/// (steps that would invert a prism are still refused). source: the raw form means something else
/// at each resolution, and is kept to compare with published figures.
struct PaperForm {
  std::vector<double> layer_stiffness;  // N/mm; one per layer
  double lambda = 0.9999;               // in (0, 1)
};
void use_paper_form(SpringPrismNet& net, const PaperForm& form);

/// Skin turgor: rest lengths of the outermost sheet's springs become c_turgor times what they are.
/// throws: InputError unless 0 < c_turgor <= 1.
void set_turgor(SpringPrismNet& net, double c_turgor);

}  // namespace condyle
