#pragma once

#include <Eigen/Core>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Space round the crowns of a scan that bone must leave: sections 8 mm wide, from about this depth
/// below the tips of the crowns in them, less than most crowns are high.
inline constexpr double crown_floor_mm = 6;
inline constexpr double crown_tube_mm = 1;  // beside the crowns at the ends of the arch
inline constexpr double wide_tube_mm = 4;   // beside the others, where no ramus is near

/// Crowns of the scan that replaces those of a case.
struct ReplacingCrowns {
  const TriMesh& scan;    // in the case
  const TriMesh& before;  // the case's crowns
  Eigen::Vector3d bite;   // about where the opposing arch is
};

/// A bone without the crowns that it carried besides its teeth.
struct BoneWithoutCrowns {
  TriMesh mesh;            // closed; the given mesh where nothing was removed; may be empty
  double removed_mm3 = 0;  // 0: it does not reach the crowns
  // It reaches them, and nothing was removed because its surface is open or faces inward.
  int open_edges = 0;
  bool inside_out = false;
};

/// Saws off what a bone has in the space round the crowns, as does a lump of a filling's streaks,
/// and drops what that sets free. Triangles away from the cuts keep the bits of their corners.
BoneWithoutCrowns without_carried_crowns(const TriMesh& bone, const ReplacingCrowns& crowns);

}  // namespace condyle
