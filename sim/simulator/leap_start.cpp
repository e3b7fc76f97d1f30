#include "sim/simulator/leap_start.h"

#include <algorithm>
#include <utility>

namespace condyle {
namespace {

constexpr double leap_mm = 4, leap_rad = 0.05;

bool same(const Pose& a, const Pose& b) { return a.t == b.t && a.R.coeffs() == b.R.coeffs(); }

bool by_same_hands(const LeapStart::Asked& a, const LeapStart::Asked& b) {
  return a.held_X_CM.has_value() == b.held_X_CM.has_value() &&
         (!a.held_X_CM || same(*a.held_X_CM, *b.held_X_CM)) &&
         std::equal(a.X_BF.begin(), a.X_BF.end(), b.X_BF.begin(), b.X_BF.end(), same);
}

bool same(const LeapStart::Asked& a, const LeapStart::Asked& b) {
  return a.request.time_s == b.request.time_s && a.request.opening_mm == b.request.opening_mm &&
         a.request.obey_contact == b.request.obey_contact && by_same_hands(a, b);
}

bool leaps(const LeapStart::Asked& from, const LeapStart::Asked& to) {
  return condyle::leaps(from.X_CM, to.X_CM) ||
         !std::equal(from.X_BF.begin(), from.X_BF.end(), to.X_BF.begin(), to.X_BF.end(),
                     [](const Pose& a, const Pose& b) { return !condyle::leaps(a, b); });
}

double way_between(const Pose& a, const Pose& b) {
  constexpr double arm_mm = 50;
  return (b.t - a.t).norm() + arm_mm * rotation_angle(a.inverse() * b);
}

}  // namespace

bool leaps(const Pose& from, const Pose& to) {
  return (to.t - from.t).norm() > leap_mm || rotation_angle(from.inverse() * to) > leap_rad;
}

std::optional<BodyPoses> LeapStart::of(const Asked& asked, const FrameState& now, bool by_hand) {
  const bool leapt = by_hand && last_ && leaps(*last_, asked);
  last_ = asked;
  if (!leapt || !asked.request.obey_contact) return {};
  if (const BodyPoses* place = before(asked)) return *place;
  return now.stopped ? from_the_motion(asked, now) : std::nullopt;
}

void LeapStart::ended(const Asked& asked, const FrameState& now) {
  if (!asked.held_X_CM) followed_ = now.X_CM;
  // Of a motion that goes on, the newest.
  if (!places_.empty() && by_same_hands(places_.back().asked, asked)) places_.pop_back();
  if (places_.size() == most) places_.pop_front();
  places_.push_back({asked, now.poses()});
}

const BodyPoses* LeapStart::before(const Asked& asked) const {
  const auto at = std::find_if(places_.rbegin(), places_.rend(),
                               [&](const Place& place) { return same(place.asked, asked); });
  return at == places_.rend() ? nullptr : &at->at;
}

std::optional<BodyPoses> LeapStart::from_the_motion(const Asked& asked,
                                                    const FrameState& now) const {
  constexpr double nearer_mm = 1, slack_mm = 0.02;
  const ContactModel::Wanted to{asked.X_CM, asked.X_BF};
  const auto slide = [&](const BodyPoses& from) {
    return scene_.contacts.slide(from, to, nullptr, threads_);
  };
  BodyPoses other = scene_.contacts.placed({followed_, asked.X_BF});
  const auto here = slide(now.poses()), there = slide(other);
  const double depth = std::max(here.contacts.max_penetration_mm(), slack_mm);
  if (there.contacts.max_penetration_mm() > depth ||
      way_between(there.at.X_CM, to.X_CM) + nearer_mm > way_between(here.at.X_CM, to.X_CM))
    return {};
  return other;
}

}  // namespace condyle
