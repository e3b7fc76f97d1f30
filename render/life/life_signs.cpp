#include "render/life/life_signs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "engine/core/hash.h"
#include "engine/math/smooth_step.h"

namespace condyle {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;

enum class Choice : std::int64_t { blink, saccade, straight, left, up };

/// 0 to 1, for one of a row of events.
double choice(std::int64_t event, Choice which) {
  constexpr std::int64_t seed = 280;  // a blink after 1.5 s, and calm eyes at first
  const std::int64_t key[2] = {event, seed + static_cast<std::int64_t>(which)};
  std::uint64_t h = hash_bytes(key, sizeof key);
  for (const std::uint64_t factor : {0xff51afd7ed558ccdull, 0xc4ceb9fe1a85ec53ull})
    h = (h ^ (h >> 33)) * factor;  // else successive numbers are alike
  return static_cast<double>((h ^ (h >> 33)) >> 11) / 9007199254740992.0;
}

/// One blink in each slot of time, at a different place in each.
double lid_closure(double time_s) {
  constexpr double slot_s = 4, first_s = 0.8, closing_s = 0.1, closed_s = 0.04, opening_s = 0.17;
  const auto slot = static_cast<std::int64_t>(std::floor(time_s / slot_s));
  const double since =
      time_s - slot_s * static_cast<double>(slot) - first_s - choice(slot, Choice::blink);
  return since < closing_s ? smooth_step(since / closing_s)
                           : 1 - smooth_step((since - closing_s - closed_s) / opening_s);
}

/// Direction of a fixation: left, up, rad. Some are straight ahead.
Eigen::Vector2d fixation(std::int64_t number) {
  constexpr double widest_deg = 8, highest_deg = 3, lowest_deg = -5, straight = 0.3;
  if (number < 1 || choice(number, Choice::straight) < straight) return {0, 0};
  return rad_per_deg *
         Eigen::Vector2d(widest_deg * (2 * choice(number, Choice::left) - 1),
                         lowest_deg + (highest_deg - lowest_deg) * choice(number, Choice::up));
}

Eigen::Vector2d gaze(double time_s) {
  constexpr double slot_s = 1.1, varies_s = 0.5;
  // source: Carpenter 1988, duration by amplitude
  constexpr double least_s = 0.021, s_per_rad = 0.0022 / rad_per_deg;
  const auto slot = static_cast<std::int64_t>(std::floor(time_s / slot_s));
  const Eigen::Vector2d from = fixation(slot - 1), to = fixation(slot);
  const double since =
      time_s - slot_s * static_cast<double>(slot) - varies_s * choice(slot, Choice::saccade);
  return from + smooth_step(since / (least_s + s_per_rad * (to - from).norm())) * (to - from);
}

double breath(double time_s) {
  constexpr double per_s = 13.5 / 60, inspiration = 0.4, expiration = 0.5;  // then a pause
  const double cycle = per_s * time_s - std::floor(per_s * time_s);
  return cycle < inspiration ? smooth_step(cycle / inspiration)
                             : 1 - smooth_step((cycle - inspiration) / expiration);
}

}  // namespace

Life life_about(const Eigen::Vector3d& condyles, const std::optional<Eigen::Vector3d>& nose_tip) {
  return {condyles + Eigen::Vector3d(0, 20, -22), nose_tip};
}

LifeSigns life_signs(double time_s, const Pose& X_CM) {
  constexpr double extension_fraction = 0.07;
  const Eigen::AngleAxisd turn(X_CM.R);
  const Eigen::Vector2d look = gaze(time_s);
  const double turns = 2 * std::numbers::pi * time_s;
  const double closure = lid_closure(time_s);
  return {.lids = {closure, closure},
          .gaze_left = look.x(),
          .gaze_up = look.y(),
          .pupil = 1 + 0.05 * std::sin(0.13 * turns) + 0.03 * std::sin(0.37 * turns),
          .breath = breath(time_s),
          .extension = extension_fraction * std::max(0.0, turn.angle() * turn.axis().x())};
}

Pose still_in_cranium(const Life& life, double extension) {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(extension, Eigen::Vector3d::UnitX()));
  return {R, life.nodding_axis - R * life.nodding_axis};
}

Camera seeing_extension(const Camera& camera, const Life& life, double extension) {
  return expressed_in(still_in_cranium(life, extension), camera);
}

}  // namespace condyle
