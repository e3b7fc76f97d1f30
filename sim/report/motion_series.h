#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/frame/frame_state.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// What is measured and drawn of a motion: its frames' measures over time. Plain curves.
struct MotionSeries {
  std::vector<double> time_s;
  std::vector<Measures> measures;
  std::vector<Pose> X_CM;
  // Between teeth, or between the bones' biting parts where a case has no teeth of their own; 0
  // when they touch, 1e300 where neither is known.
  std::vector<double> tooth_gap_mm;
  double tooth_overlap_at_rest_mm = 0;
  std::vector<std::string> muscle_names;  // of a motion that muscles drive
  std::vector<MuscleStates> muscles;      // of each frame then
  Measures rest;
  std::vector<MotionPhase> phases;
  MotionBorders borders;         // of the incisal point, where the motion has them
  bool known_landmarks = false;  // incisal points and condyles: else there is little to measure

  MotionSeries() = default;
  MotionSeries(const Scene& scene, const Motion& motion);
  void add(const FrameState& frame);

  std::size_t size() const { return time_s.size(); }
  /// Speed of the incisal point between the frames round this one, mm/s.
  double incisor_speed_mm_s(std::size_t frame) const;
  /// Downward part of it.
  double opening_speed_mm_s(std::size_t frame) const;
  /// First and last frame within a phase.
  std::pair<std::size_t, std::size_t> frames_of(const MotionPhase& phase) const;

 private:
  bool bites(const PairContact& pair) const;

  std::vector<Body> bodies_;      // of the case's parts
  std::optional<double> bite_y_;  // of cases without teeth: bone in front of it bites
};

}  // namespace condyle
