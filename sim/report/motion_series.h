#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/frame/frame_state.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Measures of a motion's frames over time, as plain curves: the input of findings and plots.
struct MotionSeries {
  std::vector<double> time_s;
  std::vector<Measures> measures;
  std::vector<Pose> X_CM;  // of the lower arch
  // Distance between the teeth, or between the occluding bone where a case has no separate teeth; 0
  // in contact, 1e300 where neither is known.
  std::vector<double> tooth_gap_mm;
  double tooth_overlap_at_rest_mm = 0;
  std::vector<std::string> muscle_names;  // of a muscle-driven motion
  std::vector<MuscleStates> muscles;      // of each frame of such a motion
  Measures rest;                          // in the closed position
  bool scanned_open = false;              // the closed position is not the rest pose of the case
  std::vector<MotionPhase> phases;
  MotionBorders borders;  // of the incisal point, where the motion has them
  bool known_landmarks =
      false;  // incisal points and condyles are marked; without them little can be measured

  MotionSeries() = default;
  MotionSeries(const Scene& scene, const Motion& motion);
  void add(const FrameState& frame);

  std::size_t size() const { return time_s.size(); }
  /// Speed of the incisal point, central difference over the neighbouring frames, mm/s.
  double incisor_speed_mm_s(std::size_t frame) const;
  /// Its downward component, mm/s.
  double opening_speed_mm_s(std::size_t frame) const;
  /// First and last frame of a phase.
  std::pair<std::size_t, std::size_t> frames_of(const MotionPhase& phase) const;

 private:
  bool bites(const PairContact& pair) const;

  std::vector<BodyId> bodies_;  // of the case's parts
  JawBodies jaw_;
  std::optional<double> bite_y_;  // of cases without teeth: bone in front of it occludes
};

}  // namespace condyle
