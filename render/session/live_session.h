#pragma once

#include <memory>
#include <optional>

#include "render/session/session_overlays.h"
#include "render/session/session_state.h"
#include "render/session/shown_bellies.h"
#include "render/session/view_overlays.h"
#include "sim/contact/live_distances.h"
#include "sim/simulator/live.h"

namespace condyle {

/// The live simulation of a session: its requests, and the delivery of its frames to the front
/// end with overlays and colours.
class LiveSession {
 public:
  explicit LiveSession(SessionState& state)
      : state_(state), bellies_(state.retired, state.waker()) {}

  /// Simulates the session's patient along its motion, from rest.
  void start();
  /// Ends the simulation before the patient changes.
  void stop();
  bool running() const { return simulation_ != nullptr; }
  /// Once a turn. `X_CM_released`: of a released jaw in motion; `paths`: of the motion, if known.
  void update(const ViewState& view, const std::optional<Pose>& X_CM_released,
              const std::shared_ptr<const LineSet>& paths);

 private:
  void request(const ViewState& view, const std::optional<Pose>& X_CM_released);
  bool take_frame(const ViewState& view);
  void show(const ViewState& view, bool is_new);

  SessionState& state_;
  Hands applied_;  // targets sent to the simulation
  ShownBellies bellies_;
  std::optional<OverlayInputs> overlaid_;
  SessionOverlayInputs overlaid_by_session_;
  bool map_sent_ = false, coloured_ = false;
  std::shared_ptr<LiveDistances> distances_;
  std::shared_ptr<LiveSimulation> simulation_;
};

}  // namespace condyle
