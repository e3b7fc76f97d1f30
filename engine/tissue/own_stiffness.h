#pragma once

#include <span>
#include <vector>

#include "engine/tissue/mesh_contact.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Resistance of each node to a displacement from x while all others stay, N/mm in the units of the
/// springs: the harmonic mean of the three principal stiffnesses, each at least 0.001 of the
/// largest. Springs count as at rest and at their full stiffness, also where they are shortened;
/// anchors and the barrier of small volumes are not included.
std::vector<double> own_stiffness(const SpringPrismMesh& mesh, const Nodes& x);

/// Limits the stiffness of contact springs to `ratio` times that of the nodes they act on. A
/// contact much stiffer than its tissue changes the energy's curvature by that ratio whenever it
/// begins or ends, and a minimizer with a preconditioner of another state needs many iterations
/// then. Multipliers enforce the contact all the same, see PointContact::push.
void limit_stiffness(std::span<const double> own, double ratio,
                     std::vector<PointContact>& contacts);

}  // namespace condyle
