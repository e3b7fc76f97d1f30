#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "engine/collide/near_samples.h"
#include "engine/collide/slide.h"
#include "engine/rigid/constraint_solver.h"
#include "engine/rigid/sample_cache.h"

namespace condyle {

/// A sample of one body that is near the surface of another.
struct SurfaceContact {
  int pair = 0, query = 0, sample = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the pair's A to its B
  double gap_mm = 0;                                  // beyond the gap to be kept or the allowance
};

/// Finds the contacts of pairs of bodies in three stages. Samples near the other surface are
/// collected from time to time; from these the relevant ones are selected whenever the bodies have
/// moved a little: a sample is irrelevant where a neighbour remains deeper for any motion. Only
/// relevant samples are evaluated each time.
class ContactFinder {
 public:
  using Surface = std::shared_ptr<const ContactSurface>;

  /// The surfaces of both bodies, each in its body's coordinates; `gap_mm` is kept between them.
  /// throws: InputError when the fields' band does not reach beyond the gap.
  void add_pair(int a, int b, std::span<const Surface> of_a, std::span<const Surface> of_b,
                double gap_mm);

  /// From now on each sample of the pair may be as deep as it is at these poses of the bodies;
  /// samples within `around_mm` of one that overlaps there are unconstrained.
  void allow_overlap(int pair, std::span<const Pose> X_WB, double around_mm);

  /// Collects near samples again where bodies have moved too far. Precedes find() and
  /// max_displacement().
  void locate(std::span<const Pose> X_WB);

  /// Contacts with a gap of at most active_mm, ordered by query and sample, without those that are
  /// irrelevant while no sample moves farther than that. Deterministic for any number of threads.
  void find(std::span<const Pose> X_WB, double active_mm, int threads,
            std::vector<SurfaceContact>& found);

  /// To be called at the end of a substep with its active distance. Where the selection has been
  /// much wider for a while, it is repeated.
  void narrow(double active_mm);

  /// Largest active distance, and so the largest displacement of nearby bodies in a step.
  double max_active_mm() const { return max_active_mm_; }

  /// Upper bound of the displacement of any sample relative to the other body's field in the given
  /// time, over all pairs that could meet.
  double max_displacement(std::span<const Pose> X_WB, std::span<const Eigen::Vector3d> centers,
                          std::span<const SolverMotion> motions, double step_s,
                          double counts_mm) const;

  const std::vector<SampleCacheKey>& sample_caches() const { return keys_; }
  void set_sample_caches(std::vector<SampleCacheKey> places);

 private:
  struct SampleQuery {  // the samples of one surface in the field of another
    int pair = 0;
    int samples_of = 0, field_of = 0;  // bodies
    bool samples_on_b = false;
    Surface samples, field;
    double radius_mm = 0;  // radius of the samples about their centroid
    double gap_mm = 0;     // kept
    double reach_mm = 0, reserve_mm = 0;
    std::vector<float> allowed;  // of each sample, mm, at most 0; empty: 0
    std::vector<NearSample> near;
    std::vector<int> group;                       // per sample: index of its group of neighbours
    std::vector<int> sifted;                      // samples
    bool is_searched = false, is_sifted = false;  // whether `near` and `sifted` match the key
    Pose X_FS;                                    // located at
    double walked_mm = 0;                         // displacement since the search
  };
  struct Candidate {  // of a selection
    int sample = 0;
    double gap_mm = 0;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // of the gap, field's coordinates
  };
  struct Place {
    int query = 0, sample = 0;
  };
  static Pose relative(const SampleQuery& query, std::span<const Pose> X_WB);
  double moved(const SampleQuery& query, const Pose& from, const Pose& to) const;
  void sift(SampleQuery& query, const SampleCacheKey& place);
  void thin(SampleQuery& query, double displacement_mm);

  std::vector<SampleQuery> queries_;
  std::vector<SampleCacheKey> keys_;  // of each query
  double max_active_mm_ = 1e9;

  // Work space of a call.
  std::vector<Eigen::Matrix3d> R_FS_, R_WF_;
  std::vector<Candidate> group_;
  std::vector<Place> places_;
  std::vector<SurfaceContact> seen_;
  std::vector<char> counts_;
};

}  // namespace condyle
