#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/collide/contact_twist.h"
#include "engine/core/parallel.h"
#include "sim/contact/drive.h"
#include "sim/contact/slider.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int most_corrections = 6;  // of what fields have wrong
constexpr double gained_mm = 0.002;  // less than this does not make a body leave where it is
constexpr double most_corrected_mm = 0.15;
constexpr double longest_step_mm = 1;
constexpr double unseen_mm = 3;  // no part of a jaw that could meet bone is thinner
constexpr double deep_mm = 0.1;
constexpr int most_steps = 400;

/// A drive on its way by sliding.
class SlidingDrive {
 public:
  SlidingDrive(const ContactModel::State& state, const Drive& drive, ContactSet& set, int threads)
      : state_(state),
        drive_(drive),
        threads_(threads),
        pairs_(concerned_pairs(state, drive)),
        set_(set) {}

  Arrival run(bool exact);

 private:
  using Found = std::vector<PairContact>;

  Passage passage(std::size_t k, const Pose& from, const Pose& to) const {
    Passage p = passage_of(state_, drive_, state_.judged(pairs_[k]), to);
    p.from = from;
    p.measure();
    return p;
  }
  Found look(const Pose& X_CD, bool rough, std::vector<OverlapDepth>* deepest = nullptr) const;
  bool clear(const Found& at_wanted) const;
  void start_limits(const Found& at_start);
  bool allowed(const PairContact& contact, std::size_t k) const {
    return contact.touching ? contact.depth_mm <= limit_[k] && kept_[k] == 0
                            : contact.distance_mm >= kept_[k] - state_.settings.slack_mm;
  }
  bool allowed(const Found& found) const {
    for (std::size_t k = 0; k < found.size(); ++k)
      if (!allowed(found[k], k)) return false;
    return true;
  }
  Pose advance(const Pose& from, const Pose& to, Found& found) const;
  Pose stretch(const Pose& X, const Pose& to, Found& found, bool proved) const;
  double way(const Pose& X, const Pose& to) const;
  Pose walk(Found& found) const;
  double free_part(const Pose& from, const Found& at_from, const Pose& to,
                   const Found& at_to) const;
  Twist correction(const Pose& X, const Found& found, const std::vector<OverlapDepth>& deepest,
                   const Twist& so_far, std::vector<ContactRow>& rows) const;
  Pose moved(const Pose& X, const Twist& x) const;
  double left(const Pose& X) const;
  Arrival arrive(const Pose& X, Found&& found) {
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      state_.slot(set_, pairs_[k]) = std::move(found[k]);
    return {X, !same_bits(X, drive_.wanted)};
  }

  const ContactModel::State& state_;
  const Drive& drive_;
  int threads_;
  std::vector<std::size_t> pairs_;
  ContactSet& set_;
  bool overlaps_at_rest_ = false;
  std::vector<double> limit_, kept_;  // depth and distance that are allowed of each pair
};

/// `rough`: of pairs that were apart at rest the depth is left out.
SlidingDrive::Found SlidingDrive::look(const Pose& X_CD, bool rough,
                                       std::vector<OverlapDepth>* deepest) const {
  Found found(pairs_.size());
  if (deepest) deepest->assign(pairs_.size(), {});
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) {
    const std::size_t i = pairs_[k];
    Looking looking = state_.full_look(i);
    looking.need_depth = !rough || !state_.judged(i).apart_at_rest;
    found[k] =
        passage(k, drive_.from(), X_CD)
            .judged(X_CD, state_.start(&set_, i), looking, deepest ? &(*deepest)[k] : nullptr);
  });
  return found;
}

/// Nothing is within reach of the whole way.
bool SlidingDrive::clear(const Found& at_wanted) const {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Passage p = passage(k, drive_.from(), drive_.wanted);
    const double margin = p.margin(at_wanted[k]);
    if (p.length_mm < 1e-12 ? margin < 0 : margin <= p.length_mm) return false;
  }
  return true;
}

/// As deep, and as near, as at rest; where it starts beyond that, no farther.
void SlidingDrive::start_limits(const Found& at_start) {
  limit_.resize(pairs_.size());
  kept_.resize(pairs_.size());
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const ColliderPair& pair = state_.judged(pairs_[k]);
    const PairContact& start = at_start[k];
    overlaps_at_rest_ |= pair.rest_depth_mm > deep_mm;
    limit_[k] = (pair.apart_at_rest ? 0 : pair.rest_depth_mm) + state_.settings.slack_mm;
    kept_[k] = pair.kept_mm;
    if (start.touching) limit_[k] = std::max(limit_[k], start.depth_mm);
    kept_[k] = std::min(kept_[k], start.distance_mm);
  }
}

Pose SlidingDrive::moved(const Pose& X, const Twist& x) const {
  const Vector3d& pivot = state_.slider->pivot(drive_.body);
  const Vector3d turn = x.tail<3>() / state_.slider->rotation_length_mm(drive_.body);
  const double angle = turn.norm();
  Pose out = X;
  if (angle > 0)
    out.R = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * X.R).normalized();
  out.t = X * pivot + x.head<3>() - out.R * pivot;
  return out;
}

/// How far a pose is from the wanted one.
double SlidingDrive::left(const Pose& X) const {
  const Vector3d& pivot = state_.slider->pivot(drive_.body);
  return std::hypot(
      (X * pivot - drive_.wanted * pivot).norm(),
      rotation_angle(X.inverse() * drive_.wanted) * state_.slider->rotation_length_mm(drive_.body));
}

/// The least motion away from X that undoes what is too deep there, as well as what was too deep at
/// the poses before it.
Twist SlidingDrive::correction(const Pose& X, const Found& found,
                               const std::vector<OverlapDepth>& deepest, const Twist& so_far,
                               std::vector<ContactRow>& rows) const {
  const double slack = state_.settings.slack_mm;
  const double length = state_.slider->rotation_length_mm(drive_.body);
  const Vector3d pivot = X * state_.slider->pivot(drive_.body);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (allowed(found[k], k)) continue;
    const PairContact& contact = found[k];
    Vector3d point = deepest[k].point, normal = deepest[k].normal;
    double gap = limit_[k] - 0.5 * slack - contact.depth_mm;
    if (!contact.touching) {
      point = contact.witness_b;
      normal = (contact.witness_b - contact.witness_a).normalized();
      gap = contact.distance_mm - kept_[k];
    } else if (contact.depth_mm == 0) {
      continue;
    }
    if (drive_.moves[static_cast<std::size_t>(state_.judged(pairs_[k]).a->body)]) normal = -normal;
    rows.push_back(contact_row(point - pivot, normal, gap, length));
    rows.back().gap_mm -= rows.back().along.dot(so_far);
  }
  TwistSettings settings;
  settings.rotation_length_mm = length;
  settings.thinning_mm = 0;
  return nearest_allowed(Twist::Zero(), rows, settings).x;
}

/// Of the straight way, how much is free of contact deeper than allowed.
double SlidingDrive::free_part(const Pose& from, const Found& at_from, const Pose& to,
                               const Found& at_to) const {
  std::vector<double> share(pairs_.size(), 1.0);
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) {
    Passage p = passage(k, from, to);
    p.limit_mm = limit_[k];
    p.kept_mm = kept_[k];
    if (p.length_mm < 1e-12) return;
    p.start_at(at_from[k]);
    share[k] = free_share(p, at_from[k], at_to[k], 0.5 * state_.settings.stop_gap_mm);
  });
  return *std::min_element(share.begin(), share.end());
}

/// Slides by the fields; what they have wrong is put right by the exact surfaces, and where that
/// fails the way ends before it. `found` is taken at `from`, and then at the pose returned.
Pose SlidingDrive::advance(const Pose& from, const Pose& to, Found& found) const {
  const bool known = state_.slider->knows(drive_);
  const Pose slid = known ? state_.slider->slide(drive_, from, to, threads_) : to;
  const Found at_from = std::move(found);
  std::vector<OverlapDepth> deepest;
  Pose X = slid;
  Twist corrected = Twist::Zero();
  std::vector<ContactRow> rows;
  for (int k = 0;; ++k) {
    found = look(X, false, &deepest);
    if (allowed(found)) return X;
    if (k == most_corrections || !known) break;
    corrected = correction(X, found, deepest, corrected, rows);
    if (corrected.norm() > most_corrected_mm) break;
    X = moved(slid, corrected);
  }
  const double share = free_part(from, at_from, X, found);
  X = interpolate(from, X, share, state_.pivot[static_cast<std::size_t>(drive_.body)]);
  found = look(X, false);
  return X;
}

/// One stretch of the way; `found` is taken at X, and then at the pose returned. `proved`: that it
/// passes through nothing.
Pose SlidingDrive::stretch(const Pose& X, const Pose& to, Found& found, bool proved) const {
  const Vector3d& pivot = state_.pivot[static_cast<std::size_t>(drive_.body)];
  if (overlaps_at_rest_) {
    // Fields know little of surfaces deep in each other, as crowns may be at rest.
    Found straight = look(to, false);
    if (allowed(straight) && free_part(X, found, to, straight) >= 1) {
      found = std::move(straight);
      return to;
    }
  }
  Found next = found;
  Pose there = advance(X, to, next);
  if (proved) {
    const double share = free_part(X, found, there, next);
    if (share < 1) {
      there = interpolate(X, there, share, pivot);
      next = look(there, false);
    }
  }
  // To stay is better than to tremble.
  if (left(there) > left(X) - gained_mm && !same_bits(there, drive_.wanted)) return X;
  found = std::move(next);
  return there;
}

double SlidingDrive::way(const Pose& X, const Pose& to) const {
  double longest = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    longest = std::max(longest, passage(k, X, to).length_mm);
  return longest;
}

/// All at once; where that goes far, in short stretches, each of them proved: fields do not know
/// walls thinner than their spacing.
Pose SlidingDrive::walk(Found& found) const {
  Pose X = drive_.from();
  Found at_once = found;
  const Pose there = stretch(X, drive_.wanted, at_once, false);
  if (way(X, there) <= unseen_mm) {
    found = std::move(at_once);
    return there;
  }
  for (int step = 0; step < most_steps && !same_bits(X, drive_.wanted); ++step) {
    double clearance = nowhere_mm;
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      clearance = std::min(clearance, found[k].touching ? 0.0 : found[k].distance_mm - kept_[k]);
    const double share = std::max(longest_step_mm, clearance) / way(X, drive_.wanted);
    const Pose to = share >= 1
                        ? drive_.wanted
                        : interpolate(X, drive_.wanted, share, state_.slider->pivot(drive_.body));
    const Pose next = stretch(X, to, found, true);
    if (same_bits(next, X)) break;
    X = next;
  }
  return X;
}

Arrival SlidingDrive::run(bool exact) {
  const Pose& from = drive_.from();
  if (pairs_.empty()) return {drive_.wanted, false};
  Found at_wanted = look(drive_.wanted, true);
  if (clear(at_wanted)) return arrive(drive_.wanted, std::move(at_wanted));
  Found at_start(pairs_.size());
  if (exact)
    for (std::size_t k = 0; k < pairs_.size(); ++k) at_start[k] = state_.slot(set_, pairs_[k]);
  else
    at_start = look(from, false);
  start_limits(at_start);
  if (same_bits(from, drive_.wanted)) return arrive(from, std::move(at_start));

  state_.slider->prepare({}, threads_);
  Found found = std::move(at_start);
  const Pose X = walk(found);
  return arrive(X, std::move(found));
}

}  // namespace

Arrival slide_drive(const ContactModel::State& state, const Drive& drive, ContactSet& set,
                    bool exact, int threads) {
  return SlidingDrive(state, drive, set, threads).run(exact);
}

}  // namespace condyle
