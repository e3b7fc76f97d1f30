#pragma once

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Definition of a flat rim, such as that where a scan ends.
struct FlatRim {
  double least_mm = 30;       // length of the longest rim in a plane
  double off_plane_mm = 0.5;  // of its vertices, at most
};

struct CappedRims {
  int rims = 0;
  double longest_rim_mm = 0;
};

/// Closes long flat rims by flat caps, those in one plane together, so that rims within others stay
/// holes of the cap. No vertex is added. Triangles are appended. The mesh must be welded, and
/// neighbours must agree on outside (`orient_outward`).
CappedRims cap_flat_rims(TriMesh& mesh, const FlatRim& flat = {});

}  // namespace condyle
