#pragma once

#include <array>
#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/slide.h"
#include "engine/collide/slide_probe.h"

namespace condyle {

/// Walk of a body towards a wanted pose, in steps that pass through nothing: it slides along what
/// is in the way, until nothing brings it nearer, which is no more than `settled_mm` at a step.
class SlideWalk {
 public:
  static constexpr double usual_settled_mm = 0.002;

  SlideWalk(const SlidingContact& model, SlideProbe& probe, const Pose& from, const Pose& wanted,
            double settled_mm = usual_settled_mm);

  /// To the end.
  SlideResult run();

  /// Takes at most so many steps. True at the end.
  bool go_on(int steps);
  /// Of a walk that is at its end.
  const SlideResult& result() const { return out_; }

 private:
  struct Cut {  // a row that held at a pose nearby
    ContactRow row;
    Pose X;
  };

  bool step();
  void end();
  void make_rows();
  void report(const TwistSolution& solution);
  void keep_cuts(const TwistSolution& solution);

  const SlidingContact& model_;
  SlideProbe& probe_;
  Pose from_, wanted_;
  double settled_mm_;
  TwistSettings solver_;
  double longest_;  // step
  int max_steps_ = 0;
  Pose X_;             // where it is
  double radius_ = 0;  // no step is longer
  double share_ = 1;   // of the way left that is asked for
  Twist last_ = Twist::Zero();
  std::array<double, 5> lately_;  // how far from the wanted pose it was
  bool ended_ = false;
  SlideResult out_, start_;
  int senseless_ = 0;  // steps, one after the other, that no body could take
  std::vector<ContactRow> rows_;
  std::vector<int> row_candidate_;  // of each row, -1 for a cut
  std::vector<Cut> cuts_;
};

}  // namespace condyle
