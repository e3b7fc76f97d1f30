#include "sim/simulator/teleport_start.h"

#include <algorithm>
#include <utility>

namespace condyle {
namespace {

constexpr double teleport_mm = 4, teleport_rad = 0.05;

bool by_same_hands(const TeleportStart::Asked& a, const TeleportStart::Asked& b) {
  if (a.follows_motion != b.follows_motion) return false;
  for (std::size_t body = 0; body < a.X_PB.size(); ++body)
    if (!a.follows_motion[body] && !bit_identical(a.X_PB[body], b.X_PB[body])) return false;
  return true;
}

bool same(const TeleportStart::Asked& a, const TeleportStart::Asked& b) {
  return a.request.time_s == b.request.time_s && a.request.opening_mm == b.request.opening_mm &&
         a.request.obey_contact == b.request.obey_contact && by_same_hands(a, b);
}

bool is_teleport(const TeleportStart::Asked& from, const TeleportStart::Asked& to) {
  return !std::equal(from.X_PB.begin(), from.X_PB.end(), to.X_PB.begin(), to.X_PB.end(),
                     [](const Pose& a, const Pose& b) { return !condyle::is_teleport(a, b); });
}

double distance_between(const Pose& a, const Pose& b) {
  constexpr double arm_mm = 50;
  return (b.t - a.t).norm() + arm_mm * rotation_angle(a.inverse() * b);
}

}  // namespace

bool is_teleport(const Pose& from, const Pose& to) {
  return (to.t - from.t).norm() > teleport_mm || rotation_angle(from.inverse() * to) > teleport_rad;
}

std::optional<BodyPoses> TeleportStart::of(const Asked& asked, const FrameState& now,
                                           bool by_hand) {
  const bool teleports = by_hand && last_ && is_teleport(*last_, asked);
  last_ = asked;
  if (!teleports || !asked.request.obey_contact) return {};
  if (const BodyPoses* place = before(asked)) return *place;
  return now.stopped ? from_the_motion(asked, now) : std::nullopt;
}

void TeleportStart::ended(const Asked& asked, const FrameState& now) {
  const BodyTree& bodies = scene_.patient.bodies;
  followed_.resize(asked.X_PB.size());
  for (std::size_t b = 1; b < followed_.size(); ++b)
    if (const BodyId body{static_cast<int>(b)}; asked.follows_motion[b])
      followed_[b] = pose_in(bodies[body].parent, body, now.poses);
  // A continuing motion is recorded only at its newest pose.
  if (!places_.empty() && by_same_hands(places_.back().asked, asked)) places_.pop_back();
  if (places_.size() == most) places_.pop_front();
  places_.push_back({asked, now.poses});
}

const BodyPoses* TeleportStart::before(const Asked& asked) const {
  const auto at = std::find_if(places_.rbegin(), places_.rend(),
                               [&](const Place& place) { return same(place.asked, asked); });
  return at == places_.rend() ? nullptr : &at->at;
}

std::optional<BodyPoses> TeleportStart::from_the_motion(const Asked& asked,
                                                        const FrameState& now) const {
  constexpr double nearer_mm = 1, slack_mm = 0.02;
  const BodyTree& bodies = scene_.patient.bodies;
  std::vector<Pose> X_PB = asked.X_PB;
  for (std::size_t b = 1; b < X_PB.size() && b < followed_.size(); ++b)
    if (bodies.moved_by_motion(BodyId{static_cast<int>(b)})) X_PB[b] = followed_[b];
  const auto slide = [&](const BodyPoses& from) {
    return scene_.contacts.slide(from, asked.X_PB, nullptr, threads_);
  };
  BodyPoses other = placed(bodies, X_PB);
  const auto here = slide(now.poses), there = slide(other);
  const double depth = std::max(here.contacts.max_penetration_mm(), slack_mm);
  const BodyId jaw = scene_.patient.jaw.lower_arch;
  const Pose to = placed(bodies, asked.X_PB)[jaw];
  if (there.contacts.max_penetration_mm() > depth ||
      distance_between(there.at[jaw], to) + nearer_mm > distance_between(here.at[jaw], to))
    return {};
  return other;
}

}  // namespace condyle
