#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "engine/collide/near_samples.h"
#include "engine/collide/slide.h"
#include "engine/rigid/looked_at.h"
#include "engine/rigid/row_solver.h"

namespace condyle {

/// A sample of one body that is near the surface of another.
struct Touch {
  int pair = 0, look = 0, sample = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the pair's A to its B
  double gap_mm = 0;                                  // beyond what is kept or allowed
};

/// Finds the touches of pairs of bodies. Samples near the other surface are searched now and then;
/// from them those that can matter are sifted, whenever the bodies moved a little: a sample does
/// not matter where a neighbour stays deeper whatever the motion. Only the others are looked at
/// each time.
class TouchFinder {
 public:
  using Surface = std::shared_ptr<const SlideBody>;

  /// Both bodies' surfaces, each in its body's coordinates; `gap_mm` is kept between them.
  /// throws: InputError when the fields' band does not reach beyond the gap.
  void add_pair(int a, int b, std::span<const Surface> of_a, std::span<const Surface> of_b,
                double gap_mm);

  /// From now on each sample of the pair may go as deep as it is at these poses of the bodies;
  /// those within `around_mm` of one that overlaps there may go anywhere.
  void allow_overlap(int pair, std::span<const Pose> X_WB, double around_mm);

  /// Searches near samples anew where bodies have moved too far since. Before find and way.
  void locate(std::span<const Pose> X_WB);

  /// Touches with a gap of at most active_mm, by look and sample, less those that do not matter
  /// while no sample moves farther than that. Same bits for any number of threads.
  void find(std::span<const Pose> X_WB, double active_mm, int threads, std::vector<Touch>& found);

  /// At the end of a part of a step: touches were asked for as far as this. Where much more was
  /// sifted for a while, it is done anew.
  void narrow(double active_mm);

  /// How far ahead touches can be asked for, and so how far bodies near each other may move in a
  /// step.
  double most_active_mm() const { return most_active_mm_; }

  /// No sample of a pair that could meet moves farther against the other body's field in the given
  /// time. Pairs that stay apart do not count.
  double way(std::span<const Pose> X_WB, std::span<const Eigen::Vector3d> centers,
             std::span<const SolverMotion> motions, double step_s, double counts_mm) const;

  const std::vector<LookedAt>& looked_at() const { return looked_at_; }
  void set_looked_at(std::vector<LookedAt> places);

 private:
  struct Look {  // at the samples of one surface in the field of another
    int pair = 0;
    int samples_of = 0, field_of = 0;  // bodies
    bool samples_on_b = false;
    Surface samples, field;
    double radius_mm = 0;  // of the samples about their centroid
    double gap_mm = 0;     // kept
    double reach_mm = 0, reserve_mm = 0;
    std::vector<float> allowed;  // of each sample, mm, at most 0; empty: 0
    std::vector<NearSample> near;
    std::vector<int> group;                       // of each sample; of neighbours, in their order
    std::vector<int> sifted;                      // samples
    bool is_searched = false, is_sifted = false;  // as looked_at says
    Pose X_FS;                                    // located at
    double walked_mm = 0;                         // since the search, straight
  };
  struct Candidate {  // of a sift
    int sample = 0;
    double gap_mm = 0;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // of the gap, field's coordinates
  };
  struct Place {
    int look = 0, sample = 0;
  };
  static Pose relative(const Look& look, std::span<const Pose> X_WB);
  double moved(const Look& look, const Pose& from, const Pose& to) const;
  void sift(Look& look, const LookedAt& place);
  void thin(Look& look, double way_mm);

  std::vector<Look> looks_;
  std::vector<LookedAt> looked_at_;  // of each look
  double most_active_mm_ = 1e9;

  // Of the call that runs.
  std::vector<Eigen::Matrix3d> R_FS_, R_WF_;
  std::vector<Candidate> group_;
  std::vector<Place> places_;
  std::vector<Touch> seen_;
  std::vector<char> counts_;
};

}  // namespace condyle
