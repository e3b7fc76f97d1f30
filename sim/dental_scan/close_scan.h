#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A scan closed below its rims.
struct ClosedScan {
  TriMesh mesh;         // the scan's triangles first
  int holes = 0;        // closed in the surface
  int skirts = 0;       // rims that were continued downward and capped
  bool closed = false;  // else some edges remain open
};

/// Closes holes by flat covers, and the longest rim of each piece by a skirt of `skirt_mm` along
/// `down`, the direction of the roots, with a cap. Triangles face outward already.
ClosedScan close_scan(TriMesh mesh, const Eigen::Vector3d& down, double skirt_mm = 4);

}  // namespace condyle
