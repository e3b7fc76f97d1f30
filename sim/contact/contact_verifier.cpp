#include "sim/contact/contact_verifier.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"
#include "sim/contact/slider.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int max_corrections = 6;  // of errors of the fields
constexpr double max_corrected_mm = 0.15;
constexpr double far_mm = 5;  // nearer pairs are measured at every pose

}  // namespace

ContactVerifier::ContactVerifier(const ContactModel::State& state, const BodyMove& move,
                                 const ContactSet& set, bool bound_far, int threads)
    : state_(state),
      move_(move),
      set_(set),
      bound_far_(bound_far),
      threads_(threads),
      pairs_(obstructing_pairs(state, move)) {
  for (const std::size_t i : pairs_) {
    const ColliderPair& pair = state_.pair_or_complement(i);
    deep_at_rest_ |= pair.rest_depth_mm > deep_mm;
    max_depth_.push_back((pair.apart_at_rest ? 0 : pair.rest_depth_mm) + state_.settings.slack_mm);
    min_distance_.push_back(pair.min_distance_mm);
  }
}

void ContactVerifier::start_at(const Found& at_start) {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    if (allowed(at_start[k], k)) continue;
    if (at_start[k].touching) max_depth_[k] = std::max(max_depth_[k], at_start[k].depth_mm);
    min_distance_[k] = std::min(min_distance_[k], at_start[k].distance_mm);
  }
}

bool ContactVerifier::allowed(const PairContact& contact, std::size_t k) const {
  return contact.touching ? contact.depth_mm <= max_depth_[k] && min_distance_[k] == 0
                          : contact.distance_mm >= min_distance_[k] - state_.settings.slack_mm;
}

bool ContactVerifier::allowed(const Found& found) const {
  for (std::size_t k = 0; k < found.size(); ++k)
    if (!allowed(found[k], k)) return false;
  return true;
}

bool ContactVerifier::allowed(const std::vector<PairResult>& results) const {
  for (std::size_t k = 0; k < results.size(); ++k)
    if (!allowed(results[k].contact, k)) return false;
  return true;
}

SweptPair ContactVerifier::swept(std::size_t k, const Pose& from, const Pose& to) const {
  SweptPair p = swept_pair(state_, move_, state_.pair_or_complement(pairs_[k]), to);
  p.from = from;
  p.measure();
  return p;
}

ContactVerifier::PairResult ContactVerifier::query(std::size_t k, const Pose& X_CD,
                                                   bool rough) const {
  const std::size_t i = pairs_[k];
  QueryOptions options = state_.full_query(i);
  options.need_depth = !rough || !state_.pair_or_complement(i).apart_at_rest;
  PairResult result;
  result.contact =
      swept(k, move_.from(), X_CD).query(X_CD, state_.start(&set_, i), options, &result.deepest);
  return result;
}

ContactVerifier::Found ContactVerifier::query_all(const Pose& X_CD) const {
  Found found(pairs_.size());
  parallel_for(pairs_.size(), threads_,
               [&](std::size_t k) { found[k] = query(k, X_CD, false).contact; });
  return found;
}

std::vector<ContactVerifier::PairResult> ContactVerifier::results_at(const Pose& X_CD) const {
  std::vector<PairResult> all(pairs_.size());
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) { all[k] = query(k, X_CD, false); });
  return all;
}

bool ContactVerifier::clear(const PairContact& at_target, std::size_t k) const {
  return swept(k, move_.from(), move_.target).clear(at_target);
}

std::optional<PairContact> ContactVerifier::far_bound(std::size_t k) const {
  PairContact bound = state_.slot(set_, pairs_[k]);
  if (!bound_far_ || bound.touching || min_distance_[k] > 0) return std::nullopt;
  bound.distance_mm -= swept(k, move_.from(), move_.target).length_mm;
  if (bound.distance_mm < far_mm) return std::nullopt;
  bound.distance_is_bound = true;
  bound.witness_a = bound.witness_b = Vector3d::Zero();
  return bound;
}

bool ContactVerifier::clear(Found& at_target) const {
  // The pair that last obstructed the motion, or was nearest to it, probably does so again: then no
  // other pair need be measured.
  std::size_t likely = 0;
  const auto before = [&](std::size_t k) -> const PairContact& {
    return state_.slot(set_, pairs_[k]);
  };
  for (std::size_t k = 1; k < pairs_.size(); ++k) {
    const PairContact &a = before(k), &b = before(likely);
    if (a.touching != b.touching ? a.touching
        : a.touching             ? a.depth_mm - max_depth_[k] > b.depth_mm - max_depth_[likely]
                     : a.distance_mm - min_distance_[k] < b.distance_mm - min_distance_[likely])
      likely = k;
  }
  const bool near = before(likely).touching || before(likely).distance_mm - min_distance_[likely] <
                                                   max_displacement_mm(move_.from(), move_.target);
  at_target.resize(pairs_.size());
  std::vector<char> is_clear(pairs_.size(), 0);
  const auto query_target = [&](std::size_t k) {
    at_target[k] = query(k, move_.target, true).contact;
    is_clear[k] = clear(at_target[k], k);
  };
  if (near) {
    if (state_.slider->surely_crosses(move_, threads_))
      return false;  // much faster than the surfaces
    query_target(likely);
    if (!is_clear[likely]) return false;
  }
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) {
    if (is_clear[k]) return;
    if (const auto bound = far_bound(k); bound && clear(*bound, k)) {
      at_target[k] = *bound;
      is_clear[k] = 1;
    } else {
      query_target(k);
    }
  });
  return std::all_of(is_clear.begin(), is_clear.end(), [](char one) { return one != 0; });
}

double ContactVerifier::max_displacement_mm(const Pose& X, const Pose& to) const {
  double longest = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    longest = std::max(longest, swept(k, X, to).length_mm);
  return longest;
}

double ContactVerifier::clearance(const Found& found) const {
  double least = nowhere_mm;
  for (std::size_t k = 0; k < found.size(); ++k)
    least = std::min(least, found[k].touching ? 0.0 : found[k].distance_mm - min_distance_[k]);
  return least;
}

double ContactVerifier::free_part(const Pose& from, const Found& at_from, const Pose& to,
                                  const Found& at_to) const {
  std::vector<double> fraction(pairs_.size(), 1.0);
  parallel_for(pairs_.size(), threads_, [&](std::size_t k) {
    SweptPair p = swept(k, from, to);
    p.max_depth_mm = max_depth_[k];
    p.min_distance_mm = min_distance_[k];
    if (p.length_mm < 1e-12) return;
    p.start_at(at_from[k]);
    fraction[k] = free_fraction(p, at_from[k], at_to[k], 0.5 * state_.settings.stop_gap_mm);
  });
  return *std::min_element(fraction.begin(), fraction.end());
}

Pose ContactVerifier::moved(const Pose& X, const Twist& x) const {
  const Vector3d& pivot = state_.slider->pivot(move_.body);
  const Vector3d turn = x.tail<3>() / state_.slider->rotation_length_mm(move_.body);
  const double angle = turn.norm();
  Pose out = X;
  if (angle > 0)
    out.R = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * X.R).normalized();
  out.t = X * pivot + x.head<3>() - out.R * pivot;
  return out;
}

/// Constraints at X of pairs that are too deep or too near, including those found at earlier poses.
void ContactVerifier::add_rows(const Pose& X, const std::vector<PairResult>& results,
                               const Twist& so_far, std::vector<ContactRow>& rows) const {
  const Vector3d pivot = X * state_.slider->pivot(move_.body);
  for (std::size_t k = 0; k < results.size(); ++k) {
    const PairContact& contact = results[k].contact;
    if (allowed(contact, k)) continue;
    Vector3d point = results[k].deepest.point, normal = results[k].deepest.normal;
    double gap = max_depth_[k] - 0.5 * state_.settings.slack_mm - contact.depth_mm;
    if (!contact.touching) {
      point = contact.witness_b;
      normal = (contact.witness_b - contact.witness_a).normalized();
      gap = contact.distance_mm - min_distance_[k];
    } else if (contact.depth_mm == 0) {
      continue;
    }
    if (move_.moves[index_of(state_.pair_or_complement(pairs_[k]).a->body)]) normal = -normal;
    rows.push_back(
        contact_row(point - pivot, normal, gap, state_.slider->rotation_length_mm(move_.body)));
    rows.back().gap_mm -= rows.back().along.dot(so_far);
  }
}

Pose ContactVerifier::project_to_valid(const SlideResult& slid, Found& found) const {
  TwistSettings settings;
  settings.rotation_length_mm = state_.slider->rotation_length_mm(move_.body);
  settings.thinning_mm = 0;
  // Constraints that hold the body remain active during the correction.
  const Vector3d pivot = slid.X_FM * state_.slider->pivot(move_.body);
  std::vector<ContactRow> rows;
  for (const SlideContact& contact : slid.contacts)
    rows.push_back(contact_row(contact.point - pivot, contact.normal,
                               std::max(0.0, contact.gap_mm + 0.5 * state_.settings.slack_mm),
                               settings.rotation_length_mm));
  Pose X = slid.X_FM;
  Twist corrected = Twist::Zero();
  std::vector<PairResult> here;
  for (int k = 0;; ++k) {
    here = results_at(X);
    if (k == max_corrections || allowed(here)) break;
    add_rows(X, here, corrected, rows);
    const Twist x = nearest_allowed(Twist::Zero(), rows, settings).x;
    if (x.norm() > max_corrected_mm) break;
    corrected = x;
    X = moved(slid.X_FM, corrected);
  }
  found.resize(pairs_.size());
  for (std::size_t k = 0; k < pairs_.size(); ++k) found[k] = std::move(here[k].contact);
  return X;
}

}  // namespace condyle
