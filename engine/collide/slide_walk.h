#pragma once

#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/slide.h"
#include "engine/collide/slide_probe.h"

namespace condyle {

/// Walks of a body towards wanted poses, in steps that pass through nothing.
class SlideWalk {
 public:
  SlideWalk(const SlidingContact& model, SlideProbe& probe) : model_(model), probe_(probe) {}

  /// Slides along what is in the way, until nothing brings it nearer: no more than `settled_mm` at
  /// a step.
  SlideResult towards(const Pose& from, const Pose& wanted, double settled_mm = 0.002);

 private:
  struct Cut {  // a row that held at a pose nearby
    ContactRow row;
    Pose X;
  };

  void make_rows(const Pose& X);
  void report(const Pose& X, const TwistSolution& solution, double share, SlideResult& out) const;
  void keep_cuts(const Pose& X, const TwistSolution& solution);

  const SlidingContact& model_;
  SlideProbe& probe_;
  std::vector<ContactRow> rows_;
  std::vector<int> row_candidate_;  // of each row, -1 for a cut
  std::vector<Cut> cuts_;
};

}  // namespace condyle
