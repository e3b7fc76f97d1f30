#pragma once

#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/sample_watch.h"
#include "engine/collide/slide.h"

namespace condyle {

/// A sample near the other body.
struct SlideCandidate {
  int pair = 0, sample = 0;
  bool known = false;
  bool faces = false;                    // the other body, with a face at the sample
  double gap = 0;                        // at the last look, beyond what is kept or allowed
  Eigen::Vector3d gradient = {0, 0, 0};  // in fixed coordinates, for motion of the moving body
  Eigen::Vector3d point = {0, 0, 0};     // in fixed coordinates
};

/// What lies near a pose. Looks at poses near each other share lists of what may be near; the
/// answers do not depend on earlier looks.
class SlideProbe {
 public:
  SlideProbe(const SlidingContact& model, int threads);

  /// Finds the samples with a gap of at most `within_mm`, and those whose gap is not known.
  void look_at(const Pose& X, double within_mm);

  /// Of the last look, by pair and sample.
  const std::vector<SlideCandidate>& candidates() const { return candidates_; }
  /// Least gap of the known ones; infinite when there are none.
  double worst_gap() const { return worst_gap_; }
  /// The same, but samples too deep to be known count as deep as the band.
  double deepest_gap() const { return deepest_gap_; }

  /// What overlaps at X, roughly: a sample of each small ball stands for all.
  struct Overlap {
    double depth_mm = 0;
    Eigen::Vector3d outward = {0, 0, 0};  // sum of the ways out, each as long as it is deep
    double sum_mm = 0;                    // of those lengths
  };
  Overlap overlap_at(const Pose& X);

  /// No larger than the gap at X, however far the bodies are.
  double clearance(const Pose& X);

  Twist between(const Pose& X, const Pose& to) const;
  Pose moved(const Pose& X, const Twist& x) const;
  /// No point of the moving body goes farther.
  double way_of(const Twist& x) const;

 private:
  double way_since(const Pose& last, const Pose& X) const;
  void come_to(const Pose& X, double within_mm);
  Placing placing(std::size_t pair, const Pose& X) const;

  const SlidingContact& model_;
  int threads_;
  std::vector<SampleWatch> watches_;  // of each pair
  std::vector<std::vector<SampleWatch::Near>> found_;
  std::vector<SlideCandidate> candidates_;
  Pose listed_at_;            // where the lists were made
  double listed_mm_ = 0;      // how far they reach there
  std::vector<Pose> looks_;   // since then
  std::vector<double> ways_;  // from each to the last
  double widest_mm_ = 0;      // band of the fields
  double worst_gap_ = 0, deepest_gap_ = 0;
};

}  // namespace condyle
