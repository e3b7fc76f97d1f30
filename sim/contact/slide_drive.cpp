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

constexpr int most_corrections = 6;    // of what fields have wrong
constexpr double gained_mm = 0.002;    // less than this does not make a body leave where it is
constexpr double checked_step_mm = 1;  // of ways past open shells
constexpr int most_checked_steps = 400;

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
  bool near_open_shell(const Found& at_wanted) const;
  Pose advance(const Pose& from, const Pose& to, Found& found) const;
  Pose checked_walk(Found& found) const;
  double free_part(const Pose& from, const Found& at_from, const Pose& to, const Found& at_to,
                   bool open_only) const;
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
    limit_[k] = (pair.apart_at_rest ? 0 : pair.rest_depth_mm) + state_.settings.slack_mm;
    kept_[k] = pair.kept_mm;
    if (start.touching) limit_[k] = std::max(limit_[k], start.depth_mm);
    kept_[k] = std::min(kept_[k], start.distance_mm);
  }
}

bool SlidingDrive::near_open_shell(const Found& at_wanted) const {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const ColliderPair& pair = state_.judged(pairs_[k]);
    if (pair.a->solid.open_shell_count() == 0 && pair.b->solid.open_shell_count() == 0) continue;
    const Passage p = passage(k, drive_.from(), drive_.wanted);
    if (at_wanted[k].touching || at_wanted[k].distance_mm <= p.length_mm) return true;
  }
  return false;
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
                               const Found& at_to, bool open_only) const {
  std::vector<double> share(pairs_.size(), 1.0);
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) {
    const ColliderPair& pair = state_.judged(pairs_[k]);
    if (open_only && pair.a->solid.open_shell_count() == 0 && pair.b->solid.open_shell_count() == 0)
      return;
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
  const Pose slid = state_.slider->slide(drive_, from, to, threads_);
  const Found at_from = std::move(found);
  std::vector<OverlapDepth> deepest;
  Pose X = slid;
  Twist corrected = Twist::Zero();
  std::vector<ContactRow> rows;
  for (int k = 0;; ++k) {
    found = look(X, false, &deepest);
    if (allowed(found)) return X;
    if (k == most_corrections) break;
    corrected = correction(X, found, deepest, corrected, rows);
    X = moved(slid, corrected);
  }
  const double share = free_part(from, at_from, X, found, false);
  X = interpolate(from, X, share, state_.pivot[static_cast<std::size_t>(drive_.body)]);
  found = look(X, false);
  return X;
}

/// In short steps, each of which is proved to pass through nothing.
Pose SlidingDrive::checked_walk(Found& found) const {
  const Vector3d& pivot = state_.pivot[static_cast<std::size_t>(drive_.body)];
  Pose X = drive_.from();
  double before = left(X);
  for (int step = 0; step < most_checked_steps; ++step) {
    double way = 0;
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      way = std::max(way, passage(k, X, drive_.wanted).length_mm);
    const Pose to = way <= checked_step_mm
                        ? drive_.wanted
                        : interpolate(X, drive_.wanted, checked_step_mm / way, pivot);
    Found next = found;
    Pose there = advance(X, to, next);
    const double share = free_part(X, found, there, next, true);
    if (share < 1) {
      there = interpolate(X, there, share, pivot);
      next = look(there, false);
    }
    const double now = left(there);
    if (now > before - gained_mm && !same_bits(there, drive_.wanted)) break;
    X = there;
    found = std::move(next);
    before = now;
    if (same_bits(X, drive_.wanted)) break;
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
  Found found = at_start;
  const Pose X =
      near_open_shell(at_wanted) ? checked_walk(found) : advance(from, drive_.wanted, found);
  // To stay is better than to tremble.
  if (!same_bits(X, drive_.wanted) && left(X) > left(from) - gained_mm)
    return arrive(from, std::move(at_start));
  return arrive(X, std::move(found));
}

}  // namespace

Arrival slide_drive(const ContactModel::State& state, const Drive& drive, ContactSet& set,
                    bool exact, int threads) {
  return SlidingDrive(state, drive, set, threads).run(exact);
}

}  // namespace condyle
