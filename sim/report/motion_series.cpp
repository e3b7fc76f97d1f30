#include "sim/report/motion_series.h"

#include <algorithm>

#include "sim/motion/measures.h"

namespace condyle {

MotionSeries::MotionSeries(const Scene& scene, const Motion& motion)
    : muscle_names(motion.muscle_names),
      rest(measure(scene.patient, {})),
      phases(motion.phases),
      borders(motion.borders) {
  known_landmarks = true;
  for (const char* name : {"lower_incisal_point", "left_condyle", "right_condyle"})
    known_landmarks &= scene.patient.landmarks.find(name).has_value();
}

void MotionSeries::add(const FrameState& frame) {
  double gap = 1e300;
  for (const auto& pair : frame.contacts.pairs)
    if (pair.policy == PairPolicy::allowed)
      gap = std::min(gap, pair.touching ? 0.0 : pair.distance_mm);
  time_s.push_back(frame.time_s);
  measures.push_back(frame.measures);
  X_CM.push_back(frame.X_CM);
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
