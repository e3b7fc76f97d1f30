#pragma once

#include <vector>

#include "engine/mesh/topology.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Area of each component, mm^2.
std::vector<double> component_areas(const TriMesh& mesh, const Components& components);

/// Signed volume of each component, mm^3: negative for cavities; without meaning for open ones.
std::vector<double> component_volumes(const TriMesh& mesh, const Components& components);

/// Drops the components whose size is below `least`, and their vertices. Returns their number.
/// size: one value per component.
int drop_components_below(TriMesh& mesh, const Components& components,
                          const std::vector<double>& size, double least);

}  // namespace condyle
