#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/contact/constrained_motion.h"
#include "sim/contact/contact_verifier.h"
#include "sim/contact/slider.h"

namespace condyle {
namespace {

using Found = ContactVerifier::Found;

constexpr double gained_mm = 0.002;  // a smaller gain does not move a body
constexpr double unseen_mm = 3;      // no part of a jaw that could meet bone is thinner
constexpr double longest_step_mm = 1;
constexpr int max_steps = 400;

/// A sliding move in progress.
class SlidingMove {
 public:
  /// `exact`: the set was taken where the move begins.
  SlidingMove(const ContactModel::State& state, const BodyMove& move, ContactSet& set, bool exact,
              bool bound_far, int threads)
      : state_(state),
        move_(move),
        exact_(exact),
        threads_(threads),
        verifier_(state, move, set, exact && bound_far, threads),
        set_(set) {}

  MoveResult run();

 private:
  std::vector<SlideResult> proposals() const;
  Pose advance(const Pose& X, const Pose& to, Found& found) const;
  Pose stretch(const Pose& X, const Pose& to, Found& found) const;
  Pose creep(Found& found) const;
  double left(const Pose& X) const;
  const Eigen::Vector3d& pivot() const { return state_.slider->pivot(move_.body); }
  MoveResult arrive(const Pose& X, Found&& found) {
    for (std::size_t k = 0; k < found.size(); ++k)
      state_.slot(set_, verifier_.pairs()[k]) = std::move(found[k]);
    return {X, !bit_identical(X, move_.target)};
  }

  const ContactModel::State& state_;
  const BodyMove& move_;
  bool exact_;
  int threads_;
  ContactVerifier verifier_;
  ContactSet& set_;
};

/// Distance of a pose from the target.
double SlidingMove::left(const Pose& X) const {
  return std::hypot(
      (X * pivot() - move_.target * pivot()).norm(),
      rotation_angle(X.inverse() * move_.target) * state_.slider->rotation_length_mm(move_.body));
}

/// Slides by the fields and, if their result is not allowed, as far towards it as possible. `found`
/// is taken at X on entry, and on return at the returned pose, to which the path is proved.
Pose SlidingMove::advance(const Pose& X, const Pose& to, Found& found) const {
  Found next;
  const Pose there = verifier_.project_to_valid(state_.slider->slide(move_, X, to, threads_), next);
  const double fraction = verifier_.free_part(X, found, there, next);
  found = std::move(next);
  if (fraction >= 1) return there;
  const Pose end = interpolate(X, there, fraction, pivot());
  found = verifier_.query_all(end);
  return end;
}

/// The same, but stays in place rather than tremble.
Pose SlidingMove::stretch(const Pose& X, const Pose& to, Found& found) const {
  Found next = found;
  const Pose there = advance(X, to, next);
  if (left(there) > left(X) - gained_mm && !bit_identical(there, move_.target)) return X;
  found = std::move(next);
  return there;
}

/// In short steps, each of them proved.
Pose SlidingMove::creep(Found& found) const {
  Pose X = move_.from();
  for (int step = 0; step < max_steps && !bit_identical(X, move_.target); ++step) {
    const double fraction = std::max(longest_step_mm, verifier_.clearance(found)) /
                            verifier_.max_displacement_mm(X, move_.target);
    const Pose to = fraction >= 1 ? move_.target : interpolate(X, move_.target, fraction, pivot());
    const Pose next = stretch(X, to, found);
    if (bit_identical(next, X)) break;
    X = next;
  }
  return X;
}

/// Candidates found by the fields, the nearest first, if the body is sure to reach them. A body
/// that overlaps deeply at rest may be held there or move freely from outside: whichever is nearer
/// to the target.
std::vector<SlideResult> SlidingMove::proposals() const {
  std::vector<SlideResult> found;
  const auto propose = [&](const Pose& from) {
    SlideResult slid = state_.slider->slide(move_, from, move_.target, threads_);
    if (slid.reached) found.push_back(std::move(slid));
  };
  if (const auto outside = state_.slider->outside(move_)) {
    propose({});
    propose(*outside);
    std::stable_sort(found.begin(), found.end(), [&](const SlideResult& a, const SlideResult& b) {
      return left(a.X_FM) < left(b.X_FM);
    });
  } else {
    propose(move_.from());
  }
  return found;
}

MoveResult SlidingMove::run() {
  const Pose &from = move_.from(), &target = move_.target;
  if (verifier_.pairs().empty()) return {target, false};
  Found at_target;
  if (verifier_.clear(at_target)) return arrive(target, std::move(at_target));

  state_.slider->prepare({}, threads_);
  if (state_.slider->covers(move_)) {
    // The fields' result depends on the target alone, and so does its correction.
    for (const SlideResult& slid : proposals()) {
      // Fields are unreliable for surfaces that overlap deeply at rest, as crowns may.
      if (verifier_.deep_at_rest() &&
          verifier_.max_displacement_mm(slid.X_FM, target) <= unseen_mm) {
        at_target = verifier_.query_all(target);
        if (verifier_.allowed(at_target)) return arrive(target, std::move(at_target));
      }
      Found found;
      const Pose X = verifier_.project_to_valid(slid, found);
      if (verifier_.allowed(found)) return arrive(X, std::move(found));
    }
  }
  Found found(verifier_.pairs().size());
  bool known = exact_;
  for (std::size_t k = 0; k < found.size(); ++k) {
    found[k] = state_.slot(set_, verifier_.pairs()[k]);
    known = known && !found[k].distance_is_bound;
  }
  if (!known) found = verifier_.query_all(from);
  verifier_.start_at(found);
  const Pose X = creep(found);
  return arrive(X, std::move(found));
}

}  // namespace

MoveResult slide_move(const ContactModel::State& state, const BodyMove& move, ContactSet& set,
                      bool exact, bool bound_far, int threads) {
  // Contacts of mixed-up jaws contradict each other; no slide past them converges.
  if (state.mixed[index_of(move.body)]) return stop(state, move, set, exact, threads);
  return SlidingMove(state, move, set, exact, bound_far, threads).run();
}

}  // namespace condyle
