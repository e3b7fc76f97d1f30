#pragma once

#include <cassert>

#include "engine/minimize/objective.h"

namespace condyle {

/// Linear extrapolation of the nodes' displacement relative to the bones over frames of equal
/// steps. It predicts where the next frame starts, so that the factor for that state can be
/// computed in advance.
class NodeExtrapolator {
 public:
  /// Records a frame that ended at `reached`; with the bones' motion alone it would have ended at
  /// `carried`.
  void add_frame(const Points& reached, const Points& carried) {
    assert(reached.size() == carried.size());
    before_.swap(last_);
    last_.resize(reached.size());
    for (std::size_t i = 0; i < reached.size(); ++i) last_[i] = reached[i] - carried[i];
  }
  /// Adds the extrapolated displacement of the next frame to nodes carried by the bones; none for
  /// nodes that have just snapped through, whose last displacement has no predictive value.
  void extrapolate(Points& carried) const {
    if (before_.size() != carried.size()) return;
    for (std::size_t i = 0; i < carried.size(); ++i) {
      const Eigen::Vector3d change = last_[i] - before_[i];
      if (change.squaredNorm() < steady_mm * steady_mm) carried[i] += last_[i] + change;
    }
  }

 private:
  static constexpr double steady_mm = 0.3;  // largest change of displacement that is extrapolated
  Points last_, before_;                    // mm
};

}  // namespace condyle
