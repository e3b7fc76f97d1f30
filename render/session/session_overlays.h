#pragma once

#include <memory>
#include <optional>

#include "render/session/session_state.h"

namespace condyle {

/// Adds what only the session shows at its newest frame, and no recording: the selected part, a cut
/// before it is made, the splint made last.
void add_session_overlays(const SessionState& state, const ViewState& view, Overlays& shown);

/// The selected part, unless it is hidden.
inline std::optional<std::size_t> visible_selection(const ViewState& view) {
  if (!view.selected || *view.selected >= view.parts.size()) return std::nullopt;
  const PartView& part = view.parts[*view.selected];
  return part.shown && part.opacity > 0 ? view.selected : std::nullopt;
}

/// What determines them; equal while nothing changes.
struct SessionOverlayInputs {
  std::optional<std::size_t> selected = {};
  std::shared_ptr<const CutOverlay> cut = {};
  std::shared_ptr<const SessionSplint> splint = {};
  bool operator==(const SessionOverlayInputs&) const = default;

  static SessionOverlayInputs of(const SessionState& state, const ViewState& view) {
    return {visible_selection(view), state.cut_overlay, state.splint};
  }
};

}  // namespace condyle
