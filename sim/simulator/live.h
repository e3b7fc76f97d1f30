#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "sim/frame/expression_level.h"
#include "sim/simulator/simulator.h"

namespace condyle {

struct LiveTarget;
class LiveSteps;

/// What the window requests of a live simulation.
struct LiveRequest {
  double time_s = 0;                                // of the motion
  std::optional<double> opening_mm = std::nullopt;  // instead of the pose of the motion
  bool obey_contact = true;
  bool face = true;  // the face is visible: its tissue is stepped and its surface computed
  std::vector<ExpressionLevel> expression = {};  // added to that of the motion
  bool operator==(const LiveRequest&) const = default;
};

/// The settings of a simulation in real time: longer steps, with a few iterations of the tissue in
/// each. Over an opening of the built-in patient 99 of 100 nodes are within 0.1 mm of the converged
/// result in half of the steps (`bench frame`); where several folds of the skin are possible, the
/// fold may differ.
SimulatorSettings live_settings(SimulatorSettings settings);

/// Steps a scene on its own thread toward the newest request: in fixed steps while the time
/// advances, in one step when it jumps. Slow drawing does not change the steps. Without new
/// requests, tissue that has not converged continues to settle, for some hundred iterations at
/// most.
class LiveSimulation {
 public:
  /// The scene must outlive the simulation. A requested opening is found along the motion
  /// `opening`; none: along the motion.
  LiveSimulation(const Scene& scene, Motion motion, const SimulatorSettings& settings,
                 std::optional<Motion> opening = std::nullopt);
  ~LiveSimulation();
  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  void request(const LiveRequest& request);

  /// Sets the target of a body that a hand holds, rest to now, in its parent's frame, until the
  /// next call or until release(). It slides along obstacles if contact is obeyed. Where the target
  /// is discontinuous (undo, a typed number) and was requested before, the bodies return to where
  /// they ended then; see TeleportStart. Once released, a body that the motion drives follows the
  /// motion again; another stays at its pose in its parent's frame. Thread-safe. throws: InputError
  /// for the cranium and for values that are not finite.
  void drag(BodyId body, const Pose& X_PB_target);
  void release(BodyId body);

  /// The newest frame if it has not been taken yet. Rethrows the exception that ended the thread.
  std::optional<FrameState> take();

  /// Steps per second that are possible, from the duration of the last ones; 0 before the first.
  double steps_per_second() const;

 private:
  void work();
  /// Waits until a step is due, or tissue is to settle. Returns none at the end.
  std::optional<LiveTarget> next_target(LiveSteps& steps);
  /// Hands a frame over, if it is to be shown; `settled_only`: the step's time is not typical.
  void publish(const FrameState* shown, bool settled_only, double seconds);
  void require_movable(BodyId body) const;

  const Scene& scene_;
  Motion motion_;
  std::optional<Motion> opening_;
  SimulatorSettings settings_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  LiveRequest request_;
  std::vector<std::optional<Pose>> held_;  // X_PB of each body that a hand holds
  long grips_ = 0;                         // number of hand movements
  std::optional<FrameState> newest_;
  std::exception_ptr failure_;
  double step_seconds_ = 0;  // recent duration of a step
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace condyle
