#pragma once

#include <optional>
#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/slide.h"
#include "sim/contact/drive.h"

namespace condyle {

/// The exact surfaces' judgement of a drive's poses: what fields propose counts only where no pair
/// is deeper, or nearer, than it may be.
class SlideJudge {
 public:
  using Found = std::vector<PairContact>;  // of each pair concerned

  /// `set`: where the queries start; it must outlive the judge. `bound_far`: it was taken where the
  /// drive begins, and what it tells to be far need not be measured.
  SlideJudge(const ContactModel::State& state, const Drive& drive, const ContactSet& set,
             bool bound_far, int threads);

  const std::vector<std::size_t>& pairs() const { return pairs_; }

  Found look(const Pose& X_CD) const;

  /// Nothing is within reach of the whole way to the wanted pose; then `at_wanted` is what was
  /// found there.
  bool clear(Found& at_wanted) const;

  /// Limits are as at rest. A start that is beyond them may stay so, but goes no farther.
  void start_at(const Found& at_start);
  bool allowed(const Found& found) const;

  /// The pose nearest to what the fields found that the exact surfaces allow, within 0.15 mm, and
  /// what was found there. It depends on `slid` and the limits alone. Where there is none, the
  /// last pose tried.
  Pose put_right(const SlideResult& slid, Found& found) const;

  /// Of the straight way, how much is free of contact deeper than allowed.
  double free_part(const Pose& from, const Found& at_from, const Pose& to,
                   const Found& at_to) const;

  /// No point goes farther between two poses.
  double way(const Pose& X, const Pose& to) const;

  /// Least distance that is left before something holds the body.
  double clearance(const Found& found) const;

  /// Some pair lies so deep in each other at rest that fields know little of it.
  bool deep_at_rest() const { return deep_at_rest_; }

 private:
  struct Look {
    PairContact contact;
    OverlapDepth deepest;
  };
  Passage passage(std::size_t k, const Pose& from, const Pose& to) const;
  /// `rough`: of pairs that were apart at rest the depth is left out.
  Look look_at(std::size_t k, const Pose& X_CD, bool rough) const;
  /// What is sure of a far pair at the wanted pose.
  std::optional<PairContact> bounded(std::size_t k) const;
  std::vector<Look> looks(const Pose& X_CD) const;
  bool clear(const PairContact& at_wanted, std::size_t k) const;
  bool allowed(const PairContact& contact, std::size_t k) const;
  bool allowed(const std::vector<Look>& looks) const;
  void add_rows(const Pose& X, const std::vector<Look>& looks, const Twist& so_far,
                std::vector<ContactRow>& rows) const;
  Pose moved(const Pose& X, const Twist& x) const;

  const ContactModel::State& state_;
  const Drive& drive_;
  const ContactSet& set_;
  bool bound_far_;
  int threads_;
  std::vector<std::size_t> pairs_;
  std::vector<double> limit_, kept_;  // depth and distance that are allowed of each pair
  bool deep_at_rest_ = false;
};

}  // namespace condyle
