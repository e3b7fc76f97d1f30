#pragma once

#include "engine/tissue/layered_mesh.h"
#include "sim/case/tissue_plan.h"

namespace condyle {

/// The layers that a plan requests; default materials where it has none. Masses are 0 where they
/// follow from the volume.
LayerStack layers_of(const TissuePlan& plan);

/// Supports and contacts are stiff enough for tissue of up to 0.1 MPa (living tissue is softer);
/// above that their stiffness is multiplied by this factor (1 or more) of the softest layer, so
/// that the response is unchanged.
double firmness_over_default(const LayerStack& layers);

/// The elements of these layers. With weight, a layer without its own mass has a density of 1
/// kg/l.
SpringPrismMesh make_elements(const TissuePlan& plan, const LayerStack& layers,
                              const std::vector<Eigen::Vector3i>& triangles, const Nodes& rest);

}  // namespace condyle
