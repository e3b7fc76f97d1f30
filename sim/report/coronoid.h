#pragma once

#include <string>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "sim/case/case.h"

namespace condyle {

/// Clearance of one coronoid process along a motion.
struct CoronoidSide {
  std::string side;                               // "left", "right"
  bool estimated = false;                         // the tip was found from the mandible's shape
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // at rest, mm
  std::vector<double> mm;                         // one per frame
  int least_frame() const;                        // the first if several
  double least_mm() const { return mm.at(static_cast<std::size_t>(least_frame())); }
};

/// Distance from the coronoid processes, the mandible's surface within 8 mm of each tip, to the
/// zygomatic bone and arch: cranial bone that lies farther from the midline than the tip does and
/// not farther back than half way from the tip to the condyle. For tips see coronoid_tip.
class CoronoidClearance {
 public:
  explicit CoronoidClearance(const Case& patient);

  /// The sides that can be measured, without values.
  const std::vector<CoronoidSide>& sides() const { return sides_; }
  /// Why a side, or both, cannot be told; empty when both are.
  const std::string& missing() const { return missing_; }

  /// mm; `start` is where an earlier answer was, and takes the new one. Thread-safe.
  double distance_mm(std::size_t side, const Pose& X_CM, TrianglePair& start) const;

 private:
  struct Surfaces {
    CollisionMesh coronoid, zygoma;
  };
  std::vector<CoronoidSide> sides_;
  std::vector<Surfaces> surfaces_;  // of each side
  std::string missing_;
};

}  // namespace condyle
