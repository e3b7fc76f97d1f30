#pragma once

#include <string>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "sim/case/case.h"
#include "sim/frame/body_poses.h"

namespace condyle {

/// Clearance of one coronoid process along a motion.
struct CoronoidSide {
  std::string side;                               // "left", "right"
  bool estimated = false;                         // the tip is estimated from the mandible's shape
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // at rest, mm
  std::vector<double> mm;                         // one per frame
  int min_frame() const;                          // frame of least distance; the first of several
  double min_mm() const { return mm.at(static_cast<std::size_t>(min_frame())); }
};

/// Distance from the coronoid processes, the mandible's surface within 8 mm of each tip, to the
/// zygomatic bone and arch: cranial bone lateral of the tip and in front of the midpoint between
/// tip and condyle. For the tips see coronoid_tip.
class CoronoidClearance {
 public:
  explicit CoronoidClearance(const Case& patient);

  /// The sides that can be measured, without values.
  const std::vector<CoronoidSide>& sides() const { return sides_; }
  /// Why a side, or both, cannot be measured; empty when both can.
  const std::string& missing() const { return missing_; }

  /// Distance, mm. `start`: triangle pair of a previous query, replaced by that of this one.
  /// Thread-safe.
  double distance_mm(std::size_t side, const BodyPoses& at, TrianglePair& start) const;

 private:
  struct Surfaces {
    CollisionMesh coronoid, zygoma;
    BodyId body;  // that the process is part of
  };
  std::vector<CoronoidSide> sides_;
  std::vector<Surfaces> surfaces_;  // of each side
  std::string missing_;
};

}  // namespace condyle
