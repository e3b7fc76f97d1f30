#pragma once

#include <algorithm>

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
    double change2 = 0;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      last_[i] = reached[i] - carried[i];
      if (!before_.empty()) change2 = std::max(change2, (last_[i] - before_[i]).squaredNorm());
    }
    steady_ = !before_.empty() && change2 < steady_mm * steady_mm;
  }
  /// Adds the next frame's own motion to nodes that bones have carried; nothing where the tissue
  /// has just snapped over, after which its last motion foretells nothing.
  void foretell(Points& carried) const {
    if (!steady_) return;
    for (std::size_t i = 0; i < carried.size(); ++i) carried[i] += 2 * last_[i] - before_[i];
  }

 private:
  static constexpr double steady_mm = 0.3;  // most that a node's own motion changes
  Points last_, before_;                    // mm
  bool steady_ = false;
};

}  // namespace condyle
