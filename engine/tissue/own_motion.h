#pragma once

#include "engine/minimize/objective.h"

namespace condyle {

/// What a tissue's nodes add of their own to the way on which bones carry them, frame by frame, in
/// a motion of equal steps: enough to say where the next frame will begin, and so to make the
/// factor for that place while there is time.
class OwnMotion {
 public:
  /// A frame has ended at `reached`; without own motion it would have ended at `carried`.
  void frame_ended(const Points& reached, const Points& carried) {
    before_.swap(last_);
    last_.resize(reached.size());
    for (std::size_t i = 0; i < reached.size(); ++i) last_[i] = reached[i] - carried[i];
  }
  /// Adds the next frame's own motion to nodes that bones have carried; nothing to those that have
  /// just snapped over, after which their last motion foretells nothing.
  void foretell(Points& carried) const {
    if (before_.size() != carried.size()) return;
    for (std::size_t i = 0; i < carried.size(); ++i) {
      const Eigen::Vector3d change = last_[i] - before_[i];
      if (change.squaredNorm() < steady_mm * steady_mm) carried[i] += last_[i] + change;
    }
  }

 private:
  static constexpr double steady_mm = 0.3;  // most that a node's own motion changes
  Points last_, before_;                    // mm
};

}  // namespace condyle
