#pragma once

#include <memory>
#include <optional>

#include "render/session/session_state.h"

namespace condyle {

/// Adds what only the session shows at its newest frame, and no recording: the selected part, a cut
/// before it is made, the splint made last.
void add_session_overlays(const SessionState& state, const ViewState& view, Overlays& shown);

/// What determines them; equal while nothing changes.
struct SessionOverlayInputs {
  std::optional<std::size_t> selected = {};
  std::shared_ptr<const CutOverlay> cut = {};
  std::shared_ptr<const SessionSplint> splint = {};
  bool operator==(const SessionOverlayInputs&) const = default;

  static SessionOverlayInputs of(const SessionState& state, const ViewState& view) {
    return {view.selected, state.cut_overlay, state.splint};
  }
};

}  // namespace condyle
