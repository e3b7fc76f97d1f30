#pragma once

#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Smooth fraction of each node between given values: the harmonic function of the spring mesh
/// (each other node is the mean of its neighbours, weighted by the springs' stiffness). Nodes that
/// contact no given one get 0.
std::vector<double> harmonic_weights(const SpringPrismMesh& mesh, const std::vector<int>& given,
                                     const std::vector<double>& value);

}  // namespace condyle
