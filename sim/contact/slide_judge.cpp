#include "sim/contact/slide_judge.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"
#include "sim/contact/slider.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int most_corrections = 6;  // of what fields have wrong
constexpr double most_corrected_mm = 0.15;
constexpr double far_mm = 5;  // what is nearer is measured at every pose

}  // namespace

SlideJudge::SlideJudge(const ContactModel::State& state, const Drive& drive, const ContactSet& set,
                       bool bound_far, int threads)
    : state_(state),
      drive_(drive),
      set_(set),
      bound_far_(bound_far),
      threads_(threads),
      pairs_(concerned_pairs(state, drive)) {
  for (const std::size_t i : pairs_) {
    const ColliderPair& pair = state_.judged(i);
    deep_at_rest_ |= pair.rest_depth_mm > deep_mm;
    limit_.push_back((pair.apart_at_rest ? 0 : pair.rest_depth_mm) + state_.settings.slack_mm);
    kept_.push_back(pair.kept_mm);
  }
}

void SlideJudge::start_at(const Found& at_start) {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    if (allowed(at_start[k], k)) continue;
    if (at_start[k].touching) limit_[k] = std::max(limit_[k], at_start[k].depth_mm);
    kept_[k] = std::min(kept_[k], at_start[k].distance_mm);
  }
}

bool SlideJudge::allowed(const PairContact& contact, std::size_t k) const {
  return contact.touching ? contact.depth_mm <= limit_[k] && kept_[k] == 0
                          : contact.distance_mm >= kept_[k] - state_.settings.slack_mm;
}

bool SlideJudge::allowed(const Found& found) const {
  for (std::size_t k = 0; k < found.size(); ++k)
    if (!allowed(found[k], k)) return false;
  return true;
}

bool SlideJudge::allowed(const std::vector<Look>& looks) const {
  for (std::size_t k = 0; k < looks.size(); ++k)
    if (!allowed(looks[k].contact, k)) return false;
  return true;
}

Passage SlideJudge::passage(std::size_t k, const Pose& from, const Pose& to) const {
  Passage p = passage_of(state_, drive_, state_.judged(pairs_[k]), to);
  p.from = from;
  p.measure();
  return p;
}

SlideJudge::Look SlideJudge::look_at(std::size_t k, const Pose& X_CD, bool rough) const {
  const std::size_t i = pairs_[k];
  Looking looking = state_.full_look(i);
  looking.need_depth = !rough || !state_.judged(i).apart_at_rest;
  Look look;
  look.contact =
      passage(k, drive_.from(), X_CD).judged(X_CD, state_.start(&set_, i), looking, &look.deepest);
  return look;
}

SlideJudge::Found SlideJudge::look(const Pose& X_CD) const {
  Found found(pairs_.size());
  parallel_for(pairs_.size(), threads_,
               [&](std::size_t k) { found[k] = look_at(k, X_CD, false).contact; });
  return found;
}

std::vector<SlideJudge::Look> SlideJudge::looks(const Pose& X_CD) const {
  std::vector<Look> all(pairs_.size());
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) { all[k] = look_at(k, X_CD, false); });
  return all;
}

bool SlideJudge::clear(const PairContact& at_wanted, std::size_t k) const {
  return passage(k, drive_.from(), drive_.wanted).clear(at_wanted);
}

std::optional<PairContact> SlideJudge::bounded(std::size_t k) const {
  PairContact bound = state_.slot(set_, pairs_[k]);
  if (!bound_far_ || bound.touching || kept_[k] > 0) return std::nullopt;
  bound.distance_mm -= passage(k, drive_.from(), drive_.wanted).length_mm;
  if (bound.distance_mm < far_mm) return std::nullopt;
  bound.distance_is_bound = true;
  bound.witness_a = bound.witness_b = Vector3d::Zero();
  return bound;
}

bool SlideJudge::clear(Found& at_wanted) const {
  // The pair that was last in the way, or nearest to it, is likely to be so again: then no other
  // need be looked at.
  std::size_t likely = 0;
  const auto before = [&](std::size_t k) -> const PairContact& {
    return state_.slot(set_, pairs_[k]);
  };
  for (std::size_t k = 1; k < pairs_.size(); ++k) {
    const PairContact &a = before(k), &b = before(likely);
    if (a.touching != b.touching ? a.touching
        : a.touching             ? a.depth_mm - limit_[k] > b.depth_mm - limit_[likely]
                                 : a.distance_mm - kept_[k] < b.distance_mm - kept_[likely])
      likely = k;
  }
  const bool near = before(likely).touching ||
                    before(likely).distance_mm - kept_[likely] < way(drive_.from(), drive_.wanted);
  at_wanted.resize(pairs_.size());
  std::vector<char> is_clear(pairs_.size(), 0);
  const auto look_there = [&](std::size_t k) {
    at_wanted[k] = look_at(k, drive_.wanted, true).contact;
    is_clear[k] = clear(at_wanted[k], k);
  };
  if (near) {
    look_there(likely);
    if (!is_clear[likely]) return false;
  }
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) {
    if (is_clear[k]) return;
    if (const auto bound = bounded(k); bound && clear(*bound, k)) {
      at_wanted[k] = *bound;
      is_clear[k] = 1;
    } else {
      look_there(k);
    }
  });
  return std::all_of(is_clear.begin(), is_clear.end(), [](char one) { return one != 0; });
}

double SlideJudge::way(const Pose& X, const Pose& to) const {
  double longest = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    longest = std::max(longest, passage(k, X, to).length_mm);
  return longest;
}

double SlideJudge::clearance(const Found& found) const {
  double least = nowhere_mm;
  for (std::size_t k = 0; k < found.size(); ++k)
    least = std::min(least, found[k].touching ? 0.0 : found[k].distance_mm - kept_[k]);
  return least;
}

double SlideJudge::free_part(const Pose& from, const Found& at_from, const Pose& to,
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

Pose SlideJudge::moved(const Pose& X, const Twist& x) const {
  const Vector3d& pivot = state_.slider->pivot(drive_.body);
  const Vector3d turn = x.tail<3>() / state_.slider->rotation_length_mm(drive_.body);
  const double angle = turn.norm();
  Pose out = X;
  if (angle > 0)
    out.R = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * X.R).normalized();
  out.t = X * pivot + x.head<3>() - out.R * pivot;
  return out;
}

/// Of what is too deep, or too near, at X: what a motion from X would do to it, with what was found
/// at the poses before.
void SlideJudge::add_rows(const Pose& X, const std::vector<Look>& looks, const Twist& so_far,
                          std::vector<ContactRow>& rows) const {
  const Vector3d pivot = X * state_.slider->pivot(drive_.body);
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const PairContact& contact = looks[k].contact;
    if (allowed(contact, k)) continue;
    Vector3d point = looks[k].deepest.point, normal = looks[k].deepest.normal;
    double gap = limit_[k] - 0.5 * state_.settings.slack_mm - contact.depth_mm;
    if (!contact.touching) {
      point = contact.witness_b;
      normal = (contact.witness_b - contact.witness_a).normalized();
      gap = contact.distance_mm - kept_[k];
    } else if (contact.depth_mm == 0) {
      continue;
    }
    if (drive_.moves[static_cast<std::size_t>(state_.judged(pairs_[k]).a->body)]) normal = -normal;
    rows.push_back(
        contact_row(point - pivot, normal, gap, state_.slider->rotation_length_mm(drive_.body)));
    rows.back().gap_mm -= rows.back().along.dot(so_far);
  }
}

Pose SlideJudge::put_right(const SlideResult& slid, Found& found) const {
  TwistSettings settings;
  settings.rotation_length_mm = state_.slider->rotation_length_mm(drive_.body);
  settings.thinning_mm = 0;
  // What holds the body goes on holding it while the rest is put right.
  const Vector3d pivot = slid.X_FM * state_.slider->pivot(drive_.body);
  std::vector<ContactRow> rows;
  for (const SlideContact& contact : slid.contacts)
    rows.push_back(contact_row(contact.point - pivot, contact.normal,
                               std::max(0.0, contact.gap_mm + 0.5 * state_.settings.slack_mm),
                               settings.rotation_length_mm));
  Pose X = slid.X_FM;
  Twist corrected = Twist::Zero();
  std::vector<Look> here;
  for (int k = 0;; ++k) {
    here = looks(X);
    if (k == most_corrections || allowed(here)) break;
    add_rows(X, here, corrected, rows);
    const Twist x = nearest_allowed(Twist::Zero(), rows, settings).x;
    if (x.norm() > most_corrected_mm) break;
    corrected = x;
    X = moved(slid.X_FM, corrected);
  }
  found.resize(pairs_.size());
  for (std::size_t k = 0; k < pairs_.size(); ++k) found[k] = std::move(here[k].contact);
  return X;
}

}  // namespace condyle
