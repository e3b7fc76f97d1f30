#pragma once

#include <array>
#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/slide.h"
#include "engine/collide/slide_probe.h"

namespace condyle {

/// Incremental motion of a body towards a target pose, in steps too short to pass through anything:
/// it slides along obstacles until a step brings it nearer by at most `settled_mm`.
class SlideWalk {
 public:
  static constexpr double default_settled_mm = 0.002;

  SlideWalk(const SlidingContact& model, SlideProbe& probe, const Pose& from, const Pose& target,
            double settled_mm = default_settled_mm);

  /// Runs to the end.
  SlideResult run();

  /// Performs at most this many steps. True at the end.
  bool go_on(int steps);
  /// The result of a finished walk.
  const SlideResult& result() const { return out_; }

 private:
  struct Cut {  // a constraint that was active at a pose nearby
    ContactRow row;
    Pose X;
  };

  bool step();
  bool gets_nowhere(double left);
  void end();
  void make_rows();
  void report(const TwistSolution& solution);
  void keep_cuts(const TwistSolution& solution);

  const SlidingContact& model_;
  SlideProbe& probe_;
  Pose from_, target_;
  double settled_mm_;
  TwistSettings solver_;
  double longest_;  // step
  int max_steps_ = 0;
  Pose X_;                    // where it is
  double radius_ = 0;         // no step is longer
  double step_fraction_ = 1;  // fraction of the remaining displacement that is requested
  Twist last_ = Twist::Zero();
  std::array<double, 5> lately_;  // recent distances from the target pose
  bool ended_ = false;
  SlideResult out_, start_;
  int infeasible_ = 0;  // number of successive infeasible steps
  int idle_ = 0;        // number of successive steps that gained nothing
  double min_depth_, min_left_;
  std::vector<ContactRow> rows_;
  std::vector<int> row_candidate_;  // per constraint; -1 for a cut
  std::vector<Cut> cuts_;
};

}  // namespace condyle
