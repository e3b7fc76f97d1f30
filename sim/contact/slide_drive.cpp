#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/contact/drive.h"
#include "sim/contact/slide_judge.h"
#include "sim/contact/slider.h"

namespace condyle {
namespace {

using Found = SlideJudge::Found;

constexpr double gained_mm = 0.002;  // less than this does not make a body leave where it is
constexpr double unseen_mm = 3;      // no part of a jaw that could meet bone is thinner
constexpr double longest_step_mm = 1;
constexpr int most_steps = 400;

/// A drive on its way by sliding.
class SlidingDrive {
 public:
  /// `exact`: the set was taken where the drive begins.
  SlidingDrive(const ContactModel::State& state, const Drive& drive, ContactSet& set, bool exact,
               bool bound_far, int threads)
      : state_(state),
        drive_(drive),
        exact_(exact),
        threads_(threads),
        judge_(state, drive, set, exact && bound_far, threads),
        set_(set) {}

  Arrival run();

 private:
  std::vector<SlideResult> proposals() const;
  Pose advance(const Pose& X, const Pose& to, Found& found) const;
  Pose stretch(const Pose& X, const Pose& to, Found& found) const;
  Pose creep(Found& found) const;
  double left(const Pose& X) const;
  const Eigen::Vector3d& pivot() const { return state_.slider->pivot(drive_.body); }
  Arrival arrive(const Pose& X, Found&& found) {
    for (std::size_t k = 0; k < found.size(); ++k)
      state_.slot(set_, judge_.pairs()[k]) = std::move(found[k]);
    return {X, !same_bits(X, drive_.wanted)};
  }

  const ContactModel::State& state_;
  const Drive& drive_;
  bool exact_;
  int threads_;
  SlideJudge judge_;
  ContactSet& set_;
};

/// How far a pose is from the wanted one.
double SlidingDrive::left(const Pose& X) const {
  return std::hypot(
      (X * pivot() - drive_.wanted * pivot()).norm(),
      rotation_angle(X.inverse() * drive_.wanted) * state_.slider->rotation_length_mm(drive_.body));
}

/// Slides by the fields, and where their answer is not allowed as far towards it as can be.
/// `found` is taken at X, and then at the pose returned, to which the way is proved.
Pose SlidingDrive::advance(const Pose& X, const Pose& to, Found& found) const {
  Found next;
  const Pose there = judge_.put_right(state_.slider->slide(drive_, X, to, threads_), next);
  const double share = judge_.free_part(X, found, there, next);
  found = std::move(next);
  if (share >= 1) return there;
  const Pose end = interpolate(X, there, share, pivot());
  found = judge_.look(end);
  return end;
}

/// The same; to stay is better than to tremble.
Pose SlidingDrive::stretch(const Pose& X, const Pose& to, Found& found) const {
  Found next = found;
  const Pose there = advance(X, to, next);
  if (left(there) > left(X) - gained_mm && !same_bits(there, drive_.wanted)) return X;
  found = std::move(next);
  return there;
}

/// In short stretches, each of them proved.
Pose SlidingDrive::creep(Found& found) const {
  Pose X = drive_.from();
  for (int step = 0; step < most_steps && !same_bits(X, drive_.wanted); ++step) {
    const double share =
        std::max(longest_step_mm, judge_.clearance(found)) / judge_.way(X, drive_.wanted);
    const Pose to = share >= 1 ? drive_.wanted : interpolate(X, drive_.wanted, share, pivot());
    const Pose next = stretch(X, to, found);
    if (same_bits(next, X)) break;
    X = next;
  }
  return X;
}

/// What fields find, the nearest first, if it is sure to be reached. A body that lies deep in
/// others at rest may be held there, though it could go elsewhere from outside: whichever is
/// nearer.
std::vector<SlideResult> SlidingDrive::proposals() const {
  std::vector<SlideResult> found;
  const auto propose = [&](const Pose& from) {
    SlideResult slid = state_.slider->slide(drive_, from, drive_.wanted, threads_);
    if (slid.reached) found.push_back(std::move(slid));
  };
  if (const auto outside = state_.slider->outside(drive_)) {
    propose({});
    propose(*outside);
    std::stable_sort(found.begin(), found.end(), [&](const SlideResult& a, const SlideResult& b) {
      return left(a.X_FM) < left(b.X_FM);
    });
  } else {
    propose(drive_.from());
  }
  return found;
}

Arrival SlidingDrive::run() {
  const Pose &from = drive_.from(), &wanted = drive_.wanted;
  if (judge_.pairs().empty()) return {wanted, false};
  Found at_wanted;
  if (judge_.clear(at_wanted)) return arrive(wanted, std::move(at_wanted));

  state_.slider->prepare({}, threads_);
  if (state_.slider->sees(drive_)) {
    // The fields' answer depends on the wanted pose alone, and so does what is put right of it.
    for (const SlideResult& slid : proposals()) {
      // They know little of surfaces that lie deep in each other at rest, as crowns may.
      if (judge_.deep_at_rest() && judge_.way(slid.X_FM, wanted) <= unseen_mm) {
        at_wanted = judge_.look(wanted);
        if (judge_.allowed(at_wanted)) return arrive(wanted, std::move(at_wanted));
      }
      Found found;
      const Pose X = judge_.put_right(slid, found);
      if (judge_.allowed(found)) return arrive(X, std::move(found));
    }
  }
  Found found(judge_.pairs().size());
  bool known = exact_;
  for (std::size_t k = 0; k < found.size(); ++k) {
    found[k] = state_.slot(set_, judge_.pairs()[k]);
    known = known && !found[k].distance_is_bound;
  }
  if (!known) found = judge_.look(from);
  judge_.start_at(found);
  const Pose X = creep(found);
  return arrive(X, std::move(found));
}

}  // namespace

Arrival slide_drive(const ContactModel::State& state, const Drive& drive, ContactSet& set,
                    bool exact, bool bound_far, int threads) {
  return SlidingDrive(state, drive, set, exact, bound_far, threads).run();
}

}  // namespace condyle
