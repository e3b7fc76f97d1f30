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
  bool faces = false;  // the nearest surface faces the sample
  double gap = 0;      // at the last query, beyond the gap to be kept or the allowance
  Eigen::Vector3d gradient = {0, 0, 0};  // in fixed coordinates, for motion of the moving body
  Eigen::Vector3d point = {0, 0, 0};     // in fixed coordinates
};

/// The contact candidates at a pose. Each query records, for each ball of samples, its position and
/// its distance from the other surface; balls that cannot have come near since are skipped. The
/// answers do not depend on earlier queries.
class SlideProbe {
 public:
  SlideProbe(const SlidingContact& model, int threads);

  /// Finds the samples with a gap of at most `within_mm`, and those whose gap is unknown.
  /// Neighbours that are not close are represented by one sample.
  void look_at(const Pose& X, double within_mm);

  /// Samples of the last query, by pair.
  const std::vector<SlideCandidate>& candidates() const { return candidates_; }
  /// Smallest known gap; infinite when there is none.
  double worst_gap() const { return worst_gap_; }
  /// The same, but samples of unknown depth count with the depth of the band.
  double deepest_gap() const { return deepest_gap_; }

  /// Approximate overlap at X: each small ball is represented by one sample.
  struct Overlap {
    double depth_mm = 0;
    Eigen::Vector3d outward = {0, 0,
                               0};  // sum of the exit displacements, each as long as the depth
    double sum_mm = 0;              // sum of their lengths
  };
  Overlap overlap_at(const Pose& X) const;
  /// Whether any sample is deeper than this.
  bool overlaps_at(const Pose& X, double depth_mm);
  /// See SlidingContact::surely_overlaps. Approximate samples alone: it misses thin overlap.
  bool surely_overlaps_at(const Pose& X) const;

  /// Lower bound of the gap at X, at any distance of the bodies.
  double clearance(const Pose& X);

  Twist between(const Pose& X, const Pose& to) const;
  Pose moved(const Pose& X, const Twist& x) const;
  /// Upper bound of the displacement of any point of the moving body.
  double max_displacement_mm(const Twist& x) const;

 private:
  struct Seen {                 // a ball of samples at its last query
    float x = 0, y = 0, z = 0;  // its centre, in field coordinates
    float gap =
        -std::numeric_limits<float>::infinity();  // lower bound of the distances of its samples
    float turned = 0;  // accumulated rotation of the body until then, rad
  };
  struct Search;
  /// Calls at(pair, sample, depth) for each representative sample that overlaps, until it returns
  /// true.
  template <class At>
  void each_overlap(const Pose& X, const At& at) const;

  const SlidingContact& model_;
  int threads_;
  std::vector<std::vector<Seen>> seen_;  // per pair and ball
  std::vector<SlideCandidate> candidates_;
  std::vector<std::vector<SlideCandidate>> found_;  // per pair
  Pose at_;                                         // of the last query
  double turned_ = 0;
  double worst_gap_ = 0, deepest_gap_ = 0;
};

}  // namespace condyle
