#pragma once

#include "engine/tissue/layered_net.h"
#include "sim/case/tissue_plan.h"

namespace condyle {

/// The layers that a plan asks for; usual materials where it does not say. Masses are left at 0
/// where they follow from the volume.
LayerStack layers_of(const TissuePlan& plan);

/// The net of these layers. With weight, a layer without a mass of its own weighs 1 kg a litre.
SpringPrismNet net_of(const TissuePlan& plan, const LayerStack& layers,
                      const std::vector<Eigen::Vector3i>& triangles, const Nodes& rest);

}  // namespace condyle
