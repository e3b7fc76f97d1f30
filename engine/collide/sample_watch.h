#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/collide/surface_samples.h"
#include "engine/math/pose.h"

namespace condyle {

/// A pose written out: it moves more points than anything else does.
struct Placing {
  explicit Placing(const Pose& X) : R(X.R.toRotationMatrix()), t(X.t) {}
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const {
    return {R(0, 0) * p.x() + R(0, 1) * p.y() + R(0, 2) * p.z() + t.x(),
            R(1, 0) * p.x() + R(1, 1) * p.y() + R(1, 2) * p.z() + t.y(),
            R(2, 0) * p.x() + R(2, 1) * p.y() + R(2, 2) * p.z() + t.z()};
  }
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
};

/// Samples that move about near a field, kept as a plain list of small balls, each with how far
/// from the field's surface it was when last asked about: what cannot have come near since is
/// passed over. What it finds does not depend on earlier looks.
class SampleWatch {
 public:
  /// `allowed`: how deep each sample may go, mm, at most 0; empty: 0.
  SampleWatch(const SurfaceSamples& samples, const DistanceField& field, double gap_mm,
              const std::vector<float>& allowed)
      : samples_(samples), field_(field), gap_mm_(gap_mm), allowed_(allowed) {}

  /// Lists the balls nearer than reach_mm. This is look 0.
  void collect(const Placing& X_FS, double reach_mm);
  /// The last look becomes look 0.
  void fold(const std::vector<double>& way);

  struct Near {
    int sample = 0;
    double gap_mm = 0;  // beyond what is kept or allowed
    FieldSample at;
    Eigen::Vector3d p;  // in the field
  };
  /// Samples with a gap of at most within_mm, by their number. way[k]: no sample went farther
  /// between look k and this one, which is the last. No ball outside the list may be so near.
  void look(const Placing& X_FS, double within_mm, const std::vector<double>& way,
            std::vector<Near>& found);
  /// Those that overlap, of one sample of each ball below 0.8 mm.
  void look_coarsely(const Placing& X_FS, const std::vector<double>& way, std::vector<Near>& found);

 private:
  struct Bound {  // of a ball
    int index = 0;
    int look = 0;   // when it was last asked about
    float gap = 0;  // none of its samples was nearer
  };
  struct Patch {
    Bound all, one;             // of the ball, and of its first sample
    int first = -1, last = -1;  // its leaves, once they were asked for
  };
  void list(const Placing& X_FS, double reach_mm, int index);
  void open(Patch& patch);
  double ball(const SurfaceSamples::Ball& ball, const Placing& X_FS) const;
  double least_gap(const FieldSample& at, const Eigen::Vector3d& p) const;
  double allowed(int sample) const {
    return allowed_.empty() ? 0.0 : static_cast<double>(allowed_[static_cast<std::size_t>(sample)]);
  }
  double samples_of(const SurfaceSamples::Ball& leaf, const Placing& X_FS, double within_mm,
                    std::vector<Near>& found) const;

  const SurfaceSamples& samples_;
  const DistanceField& field_;
  double gap_mm_;
  const std::vector<float>& allowed_;
  std::vector<Patch> patches_;  // by their samples
  std::vector<Bound> leaves_;   // in the order in which their patches were asked for
};

}  // namespace condyle
