#pragma once

#include <limits>
#include <vector>

#include "engine/collide/contact_twist.h"
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

/// What lies near a pose. Each look leaves, for each ball of samples, where it was and how far from
/// the other surface: what cannot have come near since is passed over. The answers do not depend on
/// earlier looks.
class SlideProbe {
 public:
  SlideProbe(const SlidingContact& model, int threads);

  /// Finds the samples with a gap of at most `within_mm`, and those whose gap is not known. Of
  /// neighbours that are not close one stands for all.
  void look_at(const Pose& X, double within_mm);

  /// Of the last look, by pair.
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
  Overlap overlap_at(const Pose& X) const;
  /// Whether any sample is deeper.
  bool overlaps_at(const Pose& X, double depth_mm);

  /// No larger than the gap at X, however far the bodies are.
  double clearance(const Pose& X);

  Twist between(const Pose& X, const Pose& to) const;
  Pose moved(const Pose& X, const Twist& x) const;
  /// No point of the moving body goes farther.
  double way_of(const Twist& x) const;

 private:
  struct Seen {                                           // of a ball of samples at its last look
    float x = 0, y = 0, z = 0;                            // its centre, in the field's coordinates
    float gap = -std::numeric_limits<float>::infinity();  // no sample was nearer
    float turned = 0;  // way of the body's turning until then, rad
  };
  struct Search;
  /// Calls at(pair, sample, depth) for each sample that stands for others and overlaps, until it
  /// tells to stop.
  template <class At>
  void each_overlap(const Pose& X, const At& at) const;

  const SlidingContact& model_;
  int threads_;
  std::vector<std::vector<Seen>> seen_;  // of each pair's balls
  std::vector<SlideCandidate> candidates_;
  std::vector<std::vector<SlideCandidate>> found_;  // of each pair
  Pose at_;                                         // of the last look
  double turned_ = 0;
  double worst_gap_ = 0, deepest_gap_ = 0;
};

}  // namespace condyle
