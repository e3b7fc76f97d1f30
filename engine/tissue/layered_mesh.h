#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Isotropic elastic material of one layer.
struct LayerMaterial {
  double modulus_MPa = 0.02;  // Young's modulus
  double poisson = 0.45;      // above 1/4, the value of the springs alone, and below 1/2
  double mass_kg = 0;         // of the whole layer; distributed over its nodes by volume
};

/// Volumetric stiffness of the prisms in addition to that of the springs, MPa: with mu the shear
/// modulus E / (2 (1 + nu)), mu (4 nu - 1) / (1 - 2 nu). Springs alone have Lame's first constant
/// equal to mu.
double bulk_modulus_of_prisms(const LayerMaterial& layer);

/// Layers from the outermost inward, with the thickness fraction of each.
struct LayerStack {
  std::vector<double> fraction;
  std::vector<LayerMaterial> material;
  std::vector<int> cut_from = {};  // see split_layers; empty: none is divided
};

/// 1, 2, 3 or 5 layers of facial soft tissue. source: skin and cheek 30 to 40 kPa in vivo, deeper
/// layers softer. throws: InputError for another count.
LayerStack default_layers(int count);

/// The same layers, each cut into equal ones until none is thicker than 1.2 edges: springs cannot
/// resist evenly in taller prisms (spring_map.h). Masses are shared out; cut_from tells the layer
/// of `layers` that each is of. depth_mm: of the whole stack; edge_mm: of the mesh along it;
/// `most`: where more layers than these would result, they may be thicker.
LayerStack split_layers(const LayerStack& layers, double depth_mm, double edge_mm, int most = 100);

/// Node `sheet` (0 outermost) of column `column`.
inline int node_of(int column, int sheet, int sheets) { return column * sheets + sheet; }

/// Edges of a triangle mesh, each once with its smaller vertex first, in ascending order.
std::vector<std::array<int, 2>> edges_of(const std::vector<Eigen::Vector3i>& triangles);

/// Springs over several layers, which flat layers need to resist shear (shear_springs.h). The
/// published structure has none.
enum class ShearSprings { none, over_layers };

/// Springs and prisms between sheets of the same triangle mesh. Per edge: one spring on each sheet
/// and both diagonals of each side quad, with shear springs two more over each window of layers;
/// per column: one spring across each layer.
/// `nodes` has columns * sheets entries in `node_of` order and is the rest state; triangles run
/// counter-clockwise seen from the outermost sheet; one material per layer (sheets - 1).
///
/// Spring constants follow from modulus, thickness and mesh size: k = mu A / (2 l), with l the
/// length of the spring and A = w / l the cross-section of tissue that it represents; w, of the
/// order of the prism's volume, is chosen for each prism so that it deforms as an isotropic body
/// (spring_map.h), and summed over the prisms around the spring. For regular prisms of edge l and
/// height h, sheet springs are proportional to h, springs across a layer to l^2 / h, diagonals in
/// between; equal layers give equal tissue at any mesh size. Springs that are weaker in compression
/// are multiplied by 2 / (1 + compression_ratio), for the same mean stiffness in shear. A prism's
/// volume_weight is bulk_modulus_of_prisms / (2 v).
///
/// A sheet between two layers has springs of both; in spring_layer it belongs to the layer below.
/// throws: InputError for a modulus, Poisson's ratio, mass or compression fraction out of range.
SpringPrismMesh layered_mesh(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                             const Nodes& nodes, const std::vector<LayerMaterial>& layers,
                             ShearSprings shear_springs = ShearSprings::none,
                             double compression_ratio = 0.05);

/// Converts a layered mesh to equation (1) as published: one spring constant per layer, volumes in
/// mm^3 beside lengths in mm, springs of equal stiffness in tension and compression, and no barrier
/// (steps that would invert a prism are still rejected). The published form depends on the
/// resolution; it serves to compare with published figures. Precondition: no shear springs.
struct PaperForm {
  std::vector<double> layer_stiffness;  // N/mm; one per layer
  double lambda = 0.9999;               // in (0, 1)
};
void use_paper_form(SpringPrismMesh& mesh, const PaperForm& form);

/// Skin pretension (published as turgor): multiplies the rest lengths of the outermost sheet's
/// springs by c_turgor.
/// throws: InputError unless 0 < c_turgor <= 1.
void set_turgor(SpringPrismMesh& mesh, double c_turgor);

}  // namespace condyle
