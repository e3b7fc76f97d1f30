#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "sim/case/case.h"

namespace condyle {

/// Clearance of one coronoid process, the mandible's surface within 8 mm of its tip, from the
/// zygomatic bone and arch: cranial bone that lies farther from the midline than the tip does and
/// not farther back than half way from the tip to the condyle.
struct CoronoidSide {
  std::string side;        // "left", "right"
  std::vector<double> mm;  // one per frame added
  int least_frame = 0;
  double least_mm() const { return mm.at(static_cast<std::size_t>(least_frame)); }
};

/// Measures both sides frame by frame, where the case has the landmarks left_coronoid_tip and
/// right_coronoid_tip and bone beside them.
class CoronoidClearance {
 public:
  explicit CoronoidClearance(const Case& patient);

  void add(const Pose& X_CM);

  const std::vector<CoronoidSide>& sides() const { return sides_; }
  /// Why a side, or both, cannot be told; empty when both are.
  const std::string& missing() const { return missing_; }

 private:
  struct Surfaces {
    CollisionMesh coronoid, zygoma;
    TrianglePair start;
  };
  std::vector<CoronoidSide> sides_;
  std::vector<Surfaces> surfaces_;  // of each side
  std::string missing_;
};

}  // namespace condyle
