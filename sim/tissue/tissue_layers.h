#pragma once

#include "engine/tissue/layered_net.h"
#include "sim/case/tissue_plan.h"

namespace condyle {

/// The layers that a plan asks for; usual materials where it does not say. Masses are left at 0
/// where they follow from the volume.
LayerStack layers_of(const TissuePlan& plan);

/// What holds and touches tissue is as firm as that needs which is no firmer than 0.1 MPa (living
/// tissue is softer than that); over it, by this factor (1 and more) of the softest layer, so that
/// the whole answers as before.
double firmness_over_usual(const LayerStack& layers);

/// The net of these layers. With weight, a layer without a mass of its own weighs 1 kg a litre.
SpringPrismNet net_of(const TissuePlan& plan, const LayerStack& layers,
                      const std::vector<Eigen::Vector3i>& triangles, const Nodes& rest);

}  // namespace condyle
