#pragma once

#include <optional>
#include <vector>

#include "sim/simulator/live.h"
#include "sim/simulator/opening_times.h"
#include "sim/simulator/teleport_start.h"

namespace condyle {

/// The target of a live simulation at one moment.
struct LiveTarget {
  LiveRequest request;
  std::vector<std::optional<Pose>> X_PB_held;  // of each body that a hand holds
  long grips = 0;                              // number of hand movements
};

/// The tissue's budget in one live step, from that of a step in real time: larger for tissue that
/// settles after the last request; the full one where the jaw's target is far away, or where the
/// last solve failed and kept the earlier state.
TissueBudget live_budget(TissueBudget keeping_up, bool settles, bool jaw_teleports,
                         bool reused_before);

/// The steps of a live simulation toward its targets, one at a time; without threads, and without a
/// clock except for the times of stages.
class LiveSteps {
 public:
  /// All must outlive it. A requested opening is found along `opening`.
  LiveSteps(const Scene& scene, const Motion& motion, const Motion& opening,
            const SimulatorSettings& settings);

  /// Whether a step is due: the target has changed, or was not reached yet.
  bool due(const LiveRequest& request, long grips) const {
    return !caught_up_ || request != answered_ || grips != answered_grips_;
  }
  /// Steps that are left to settle tissue after the target was reached; at first max_settling.
  int settling() const { return settling_; }
  static constexpr int max_settling = 20;
  void stop_settling() { settling_ = 0; }

  /// Whether the next step is one of several toward the target, as while time runs on.
  bool runs_on(const LiveRequest& request) const;

  /// One step. A frame that is not shown has only lower bounds of far distances, and no face.
  void step(const LiveTarget& target, bool shown);
  const FrameState& frame() const { return now_; }

 private:
  StepInput input(const LiveTarget& target, double time_s, bool shown);
  FaceExcitation excitation(const LiveRequest& request, double time_s) const;
  void begin_at(const BodyPoses& poses);
  TeleportStart::Asked asked(const LiveTarget& target, const StepInput& input) const;
  SimulatorSettings settings_for(const LiveTarget& target, const StepInput& input) const;
  void keep_moved(const LiveTarget& target);
  void count_settling(bool tissue);

  const Scene& scene_;
  const Motion& motion_;
  const Motion& opening_;
  const SimulatorSettings& settings_;
  OpeningTimes opening_times_;
  TeleportStart teleport_start_;
  FrameState now_;
  TissueWarmStart warm_;
  std::vector<Pose> X_PB_moved_;  // poses to which hands have moved bodies
  LiveRequest answered_;
  long answered_grips_ = 0;
  bool caught_up_ = false;  // with the answered target
  int settling_ = 0;
};

}  // namespace condyle
