#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/tissue/spring_map.h"

namespace condyle {

/// A prism of a stack, the tissue between a triangle of the outermost sheet and the innermost one.
struct StackedPrism {
  std::array<Eigen::Vector3d, 6> corners;
  double volume = 0;  // mm^3
  double shear = 0;   // modulus of its springs, MPa
  PrismWeights weights;
};

/// Consecutive layers of a stack.
struct LayerWindow {
  int first = 0, count = 0;
};

/// Windows that divide the layers, of three each unless these are so flat that more are needed for
/// steep springs. None for a single layer. `flatness`: mean height of a layer over the length of an
/// edge.
std::vector<LayerWindow> layer_windows(int layers, double flatness);

/// Springs of flat prisms resist shear across the layer too little (spring_map.h): in layers of a
/// third of an edge half as much as isotropic tissue, in layers of a sixth a tenth of it. Springs
/// over several layers are steeper and add what is missing to each window as a whole, so that its
/// outermost sheet is held to its innermost one as by isotropic layers.
///
/// Returns, for each window, the weight of the six springs that join these sheets over the edges of
/// the triangle (N mm: shear modulus times volume). Their stiffness along the sheets is taken from
/// springs and diagonals in the layers, whose weights in `stack` are reduced; a single layer may
/// then resist shear even less. Windows of less than half an edge stay softer than the tissue:
/// their springs may add no more than 0.3 of its stiffness along the sheets.
std::vector<double> take_shear_weights(std::vector<StackedPrism>& stack,
                                       const std::vector<LayerWindow>& windows);

}  // namespace condyle
