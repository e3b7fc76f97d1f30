#pragma once

#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Smooth share of each node between given values: the harmonic function of the spring net (each
/// other node is the mean of its neighbours, weighted by the springs' stiffness). Nodes that touch
/// no given one get 0.
std::vector<double> harmonic_shares(const SpringPrismNet& net, const std::vector<int>& given,
                                    const std::vector<double>& value);

}  // namespace condyle
