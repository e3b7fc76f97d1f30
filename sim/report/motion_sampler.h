#pragma once

#include <vector>

#include "sim/simulator/simulator.h"

namespace condyle {

/// How a motion is divided into frames.
struct CheckSampling {
  int frames = 0;   // number of frames, both ends included; 0 = by fps
  double fps = 30;  // frames per second
};

/// Times of the frames, increasing from 0 to the end of the motion. Without a requested number
/// there are at most 3000: a longer motion is sampled in longer steps.
std::vector<double> frame_times(const Motion& motion, const CheckSampling& sampling);

/// Contact state of one pair at one time.
struct PairSample {
  PairContact contact;  // without its list of contact points
  int contacts = 0;
  double depth_mm = 0;     // at the deepest point; 0 when apart
  bool was_apart = false;  // at rest the surfaces are apart at that point
  // Remaining approach before the pair is deeper than at rest; the signed distance of bones that
  // are apart at rest. Changes by at most 1 mm per mm of relative motion.
  double to_go_mm = 0;

  double beyond_rest_mm() const { return std::max(0.0, contact.depth_mm - contact.rest_depth_mm); }
  /// mm; negative: depth at the deepest point.
  double signed_distance_mm() const { return contact.touching ? -depth_mm : contact.distance_mm; }
};

std::vector<PairSample> samples_of(const ContactSet& set);

/// All pairs at one time, at a frame or between two frames.
struct Moment {
  double time_s = 0;
  std::vector<PairSample> pairs;
};

/// Samples a motion also between its frames, so that no contact is missed there.
class MotionSampler {
 public:
  /// `step_s`: the motion is linear within such a step. The scene and motion must outlive this.
  MotionSampler(const Scene& scene, const Motion& motion, double step_s);

  BodyPoses poses(double time_s) const {
    const BodyTree& bodies = scene_.patient.bodies;
    const std::vector<Pose> others = motion_.pieces ? motion_.pieces(time_s) : std::vector<Pose>{};
    return placed(bodies, motion_target_poses(bodies, motion_.target(time_s), others));
  }

  /// Upper bound of the relative displacement of any point of the pair from t0 to t1, mm.
  double motion_bound_mm(std::size_t pair, double t0, double t1) const;

  /// Times between the frames at which a pair may exceed what the frames show: touch before the
  /// first touching frame, or come 0.1 mm closer or deeper than its worst frame and closer than
  /// `reach_mm`, the largest clearance of interest. All other times are excluded by conservative
  /// advancement; displacements up to 0.1 mm are assessed at their ends. In order of time;
  /// bit-identical for any number of threads.
  std::vector<Moment> between(const std::vector<Moment>& frames,
                              const std::vector<double>& reach_mm, int threads) const;

  struct Nearest {
    std::vector<Moment> moments;
    int samples = 0;  // contact queries
  };
  /// The moments at which a pair is nearest or deepest: the three lowest local minima of the
  /// samples, each refined between its neighbours to 0.01 mm. `moments`: in order of time.
  Nearest nearest(std::size_t pair, const std::vector<Moment>& moments) const;

  /// Time of first contact of a pair that is apart at t0 and touches at `touching`, to 0.02 mm of
  /// motion.
  Moment first_touch(std::size_t pair, double t0, const Moment& touching) const;

 private:
  struct Watch;  // per pair: what would exceed the frames
  void search(const Moment& a, const Moment& b, const std::vector<Watch>& watches,
              std::size_t interval, ContactSet& previous, std::vector<Moment>& found) const;
  Moment at(double time_s, ContactSet& previous) const;
  /// The lowest moment of a pair between `before` and `after`, of which `low` is not higher than
  /// either, as far as it may be lower than `limit_mm`.
  Moment refined(std::size_t pair, Moment before, Moment low, Moment after, double limit_mm,
                 int& samples) const;

  const Scene& scene_;
  const Motion& motion_;
  std::vector<double> times_;  // knots; linear in between
  std::vector<std::vector<double>>
      path_length_;  // per pair: bound of the path length up to each time
};

}  // namespace condyle
