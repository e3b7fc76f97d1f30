#pragma once

#include <vector>

#include "sim/simulator/simulator.h"

namespace condyle {

/// Which moments of a motion are frames.
struct CheckSampling {
  int frames = 0;   // the whole motion in this many, both ends included; 0 = by fps
  double fps = 30;  // frames a second
};

/// Times of the frames, rising from 0 to the motion's end. Without a number asked for there are at
/// most 3000: a longer motion is walked in longer steps.
std::vector<double> frame_times(const Motion& motion, const CheckSampling& sampling);

/// One pair at one moment.
struct PairSample {
  PairContact contact;  // without its list of contacts
  int contacts = 0;
  double depth_mm = 0;     // at the deepest place; 0 when apart
  bool was_apart = false;  // there, at rest
  // How far it may come nearer, or sink deeper, before it is deeper than at rest; where bones are
  // apart at rest, their signed distance. Changes by at most a millimetre per millimetre of motion.
  double to_go_mm = 0;

  double beyond_rest_mm() const { return std::max(0.0, contact.depth_mm - contact.rest_depth_mm); }
  /// mm; negative: depth at the deepest place.
  double signed_distance_mm() const { return contact.touching ? -depth_mm : contact.distance_mm; }
};

std::vector<PairSample> samples_of(const ContactSet& set);

/// All pairs at a moment, which is a frame or lies between two.
struct Moment {
  double time_s = 0;
  std::vector<PairSample> pairs;
};

/// Walks the ways between frames, so that nothing passes between them unseen.
class MotionWalk {
 public:
  /// `step_s`: in between, the motion is taken as straight. The scene and motion must outlive this.
  MotionWalk(const Scene& scene, const Motion& motion, double step_s);

  BodyPoses poses(double time_s) const { return {motion_.wanted(time_s)}; }

  /// No point of either part of the pair moves farther against the other from t0 to t1, mm.
  double way_mm(std::size_t pair, double t0, double t1) const;

  /// Moments between the frames at which a pair may do what no frame shows: come to touch at all
  /// before the first frame that touches, or come 0.1 mm nearer or deeper than its worst frame and
  /// than `reach_mm`, the clearance from which it matters. Proven by clearance and motion; ways up
  /// to 0.1 mm are judged by their ends. In time order; same bits for any number of threads.
  std::vector<Moment> between(const std::vector<Moment>& frames,
                              const std::vector<double>& reach_mm, int threads) const;

  /// When the pair comes to touch, to 0.02 mm of motion: apart at t0, touching at t1.
  Moment first_touch(std::size_t pair, double t0, const Moment& touching) const;

 private:
  struct Watch;  // of one pair: what would be news
  void look(const Moment& a, const Moment& b, const std::vector<Watch>& watches,
            std::size_t interval, ContactSet& previous, std::vector<Moment>& found) const;
  Moment at(double time_s, ContactSet& previous) const;

  const Scene& scene_;
  const Motion& motion_;
  std::vector<double> times_;              // straight between
  std::vector<std::vector<double>> gone_;  // of each pair: way from the start, at each time
};

}  // namespace condyle
