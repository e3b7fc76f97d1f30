#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "render/window/picture/render_request.h"

namespace condyle {

/// Draws pictures of the window's 3-D view and keeps buffers for pictures of one size. Needs a
/// current OpenGL 3.3 core context for its lifetime.
class ViewPicture {
 public:
  ViewPicture();
  ~ViewPicture();
  ViewPicture(const ViewPicture&) = delete;
  ViewPicture& operator=(const ViewPicture&) = delete;

  /// Draws the renderer's state at the request's quality; the settings state the full size. For a
  /// wipe `turn_to` switches to the state beside (true) and back to the request's own. Large
  /// pictures of the best quality, at rest, are drawn column by column: none is returned if
  /// `given_up` reports between two columns that the picture is no longer needed. throws:
  /// MachineError when the driver cannot draw a picture of this size.
  std::optional<DrawnPicture> draw(SceneRenderer& renderer, const RenderRequest& request,
                                   const std::function<void(bool beside)>& turn_to,
                                   const std::function<bool()>& given_up = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
