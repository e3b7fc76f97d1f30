#include "sim/report/motion_series.h"

#include <algorithm>

#include "sim/motion/measure_pose.h"

namespace condyle {

MotionSeries::MotionSeries(const Scene& scene, const Motion& motion)
    : muscle_names(motion.muscle_names),
      rest(measure(scene.patient, BodyPoses(scene.patient.X_CM_closed))),
      phases(motion.phases),
      borders(motion.borders) {
  jaw_ = scene.patient.jaw;
  scanned_open = !bit_identical(scene.patient.X_CM_closed, {});
  known_landmarks = true;
  for (const char* name : {"lower_incisal_point", "left_condyle", "right_condyle"})
    known_landmarks &= scene.patient.landmarks.find(name).has_value();
  for (const auto& part : scene.patient.parts) bodies_.push_back(part.body);
  if (known_landmarks && !scene.patient.has_both_arches()) {
    constexpr double front_fraction = 0.4;  // of the distance from the condyles to the incisors
    const double hinge_y = 0.5 * (rest.left_condyle.y() + rest.right_condyle.y());
    bite_y_ = hinge_y + front_fraction * (rest.incisor.y() - hinge_y);
  }
}

/// Whether the distance of a pair is that of the occlusal surfaces.
bool MotionSeries::bites(const PairContact& pair) const {
  if (pair.policy == PairPolicy::allowed) return true;
  const auto body = [&](int part) { return bodies_.at(static_cast<std::size_t>(part)); };
  if (!bite_y_ || pair.distance_is_bound || body(pair.part_a) != jaw_.upper_arch ||
      body(pair.part_b) != jaw_.lower_arch)
    return false;
  if (!pair.touching) return pair.witness_a.y() < *bite_y_;
  return std::any_of(pair.contacts.begin(), pair.contacts.end(),
                     [&](const ContactPoint& contact) { return contact.point.y() < *bite_y_; });
}

void MotionSeries::add(const FrameState& frame) {
  double gap = 1e300;
  for (const auto& pair : frame.contacts.pairs) {
    if (!bites(pair)) continue;
    gap = std::min(gap, pair.touching ? 0.0 : pair.distance_mm);
    tooth_overlap_at_rest_mm = std::max(tooth_overlap_at_rest_mm, pair.rest_depth_mm);
  }
  time_s.push_back(frame.time_s);
  measures.push_back(frame.measures);
  X_CM.push_back(frame.poses[jaw_.lower_arch]);
  if (frame.muscles.size() == muscle_names.size() && !muscle_names.empty())
    muscles.push_back(frame.muscles);
  tooth_gap_mm.push_back(gap);
}

double MotionSeries::incisor_speed_mm_s(std::size_t frame) const {
  const std::size_t a = frame > 0 ? frame - 1 : 0, b = std::min(frame + 1, size() - 1);
  const double dt = time_s[b] - time_s[a];
  return dt > 0 ? (measures[b].incisor - measures[a].incisor).norm() / dt : 0;
}

double MotionSeries::opening_speed_mm_s(std::size_t frame) const {
  const std::size_t a = frame > 0 ? frame - 1 : 0, b = std::min(frame + 1, size() - 1);
  const double dt = time_s[b] - time_s[a];
  return dt > 0 ? (measures[b].opening_mm - measures[a].opening_mm) / dt : 0;
}

std::pair<std::size_t, std::size_t> MotionSeries::frames_of(const MotionPhase& phase) const {
  constexpr double rounding_s = 1e-9;
  const auto low = std::lower_bound(time_s.begin(), time_s.end(), phase.start_s - rounding_s);
  const auto high = std::upper_bound(low, time_s.end(), phase.end_s + rounding_s);
  const auto first = static_cast<std::size_t>(low - time_s.begin());
  const auto end = static_cast<std::size_t>(high - time_s.begin());
  return {std::min(first, size() - 1), end > first ? end - 1 : std::min(first, size() - 1)};
}

}  // namespace condyle
