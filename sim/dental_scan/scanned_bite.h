#pragma once

#include <Eigen/Core>
#include <string>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"
#include "sim/dental_scan/arch_fit.h"

namespace condyle {

/// Whether two scans in one frame lie in occlusion.
struct ScannedBite {
  bool in_occlusion = false;
  int left = 0, right = 0;  // places where crowns face each other, 0.3 mm deep to 0.5 mm apart
  double overlapping = 0;   // fraction of the lower crowns' points inside the upper crowns
  std::string why;          // as a clause, if not in occlusion
};

/// In occlusion: three or more places on both sides of the midline, and hardly any overlap.
/// X_CU: the common frame in the case, in which left and up are known.
ScannedBite scanned_bite(const TriMesh& upper, const TriMesh& lower, const Pose& X_CU,
                         double midline_mm);

/// How far the lower arch, registered by itself, lies from where the upper scan carries it.
struct BiteError {
  Pose X_CM;              // of the mandible in the scanned bite
  double largest_mm = 0;  // at the incisors and first molars
  double rotation_deg = 0;
};
BiteError bite_error(const ArchFit& upper, const ArchFit& lower, const ArchTarget& lower_target);

}  // namespace condyle
