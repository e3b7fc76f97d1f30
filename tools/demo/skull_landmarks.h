#pragma once

#include "engine/mesh/tri_mesh.h"
#include "sim/case/landmarks.h"

namespace condyle {

/// Nasion, basion, porions and orbitales of a skull in LPS from its extents alone, by the
/// proportions of adult skulls: for the directions and borders of a vault cut where nobody marked
/// them. Errors of a centimetre are usual.
Landmarks estimate_skull_landmarks(const TriMesh& skull);

}  // namespace condyle
