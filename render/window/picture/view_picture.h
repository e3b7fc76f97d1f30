#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "render/window/picture/render_request.h"

namespace condyle {

/// Draws pictures of the window's 3-D view and keeps what pictures of one size share. Needs a
/// current OpenGL 3.3 core context for its whole life.
class ViewPicture {
 public:
  ViewPicture();
  ~ViewPicture();
  ViewPicture(const ViewPicture&) = delete;
  ViewPicture& operator=(const ViewPicture&) = delete;

  /// Draws what the renderer has, at the request's quality; the settings give the full size. For a
  /// wipe `turn_to` shows the state beside (true) and the request's own, which is left. Large
  /// pictures of the best quality, at rest, are drawn column by column: none when `given_up` says,
  /// between two, that nobody waits for it any more. throws: MachineError when the driver cannot
  /// make a picture of this size.
  std::optional<DrawnPicture> draw(SceneRenderer& renderer, const RenderRequest& request,
                                   const std::function<void(bool beside)>& turn_to,
                                   const std::function<bool()>& given_up = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
