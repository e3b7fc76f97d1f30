#pragma once

#include <optional>
#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/slide.h"
#include "sim/contact/constrained_motion.h"

namespace condyle {

/// Verification of a move's poses by the exact surfaces: a pose proposed by fields is accepted only
/// if no pair is deeper, or nearer, than allowed.
class ContactVerifier {
 public:
  using Found = std::vector<PairContact>;  // of each pair concerned

  /// `set`: where the queries start; it must outlive the verifier. `bound_far`: it was taken where
  /// the move begins, and pairs that it reports as far need not be measured.
  ContactVerifier(const ContactModel::State& state, const BodyMove& move, const ContactSet& set,
                  bool bound_far, int threads);

  const std::vector<std::size_t>& pairs() const { return pairs_; }

  Found query_all(const Pose& X_CD) const;

  /// Whether no pair is within reach of the whole path to the target; then `at_target` has the
  /// result there.
  bool clear(Found& at_target) const;

  /// Limits are as at rest. A start beyond them is tolerated, but must not deepen.
  void start_at(const Found& at_start);
  bool allowed(const Found& found) const;

  /// The pose nearest to the fields' result that the exact surfaces allow, within 0.15 mm, and the
  /// contacts there. It depends on `slid` and the limits only. If there is none, the last pose
  /// tried.
  Pose project_to_valid(const SlideResult& slid, Found& found) const;

  /// Fraction of the straight path that is free of contact deeper than allowed.
  double free_part(const Pose& from, const Found& at_from, const Pose& to,
                   const Found& at_to) const;

  /// Upper bound of the displacement of any point between two poses.
  double max_displacement_mm(const Pose& X, const Pose& to) const;

  /// Smallest remaining distance before a pair holds the body.
  double clearance(const Found& found) const;

  /// Whether a pair is so deep at rest that fields are unreliable.
  bool deep_at_rest() const { return deep_at_rest_; }

 private:
  struct PairResult {
    PairContact contact;
    OverlapDepth deepest;
  };
  SweptPair swept(std::size_t k, const Pose& from, const Pose& to) const;
  /// `rough`: without the depth of pairs that were apart at rest.
  PairResult query(std::size_t k, const Pose& X_CD, bool rough) const;
  /// Lower bound for a far pair at the target.
  std::optional<PairContact> far_bound(std::size_t k) const;
  std::vector<PairResult> results_at(const Pose& X_CD) const;
  bool clear(const PairContact& at_target, std::size_t k) const;
  bool allowed(const PairContact& contact, std::size_t k) const;
  bool allowed(const std::vector<PairResult>& results) const;
  void add_rows(const Pose& X, const std::vector<PairResult>& results, const Twist& so_far,
                std::vector<ContactRow>& rows) const;
  Pose moved(const Pose& X, const Twist& x) const;

  const ContactModel::State& state_;
  const BodyMove& move_;
  const ContactSet& set_;
  bool bound_far_;
  int threads_;
  std::vector<std::size_t> pairs_;
  std::vector<double> max_depth_, min_distance_;  // allowed depth and distance of each pair
  bool deep_at_rest_ = false;
};

}  // namespace condyle
