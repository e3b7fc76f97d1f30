#pragma once

#include <memory>
#include <optional>

#include "render/camera.h"
#include "render/window/quality.h"

namespace condyle {

class SceneRenderer;
struct PictureSettings;
struct FrameState;

/// Two states in one picture: up to a share of the width one, from there on the other.
struct Wipe {
  const FrameState* left;
  const FrameState* right;
  double at;
};

/// The last 3-D picture as a texture, so that panels can be redrawn without drawing the patient.
class ViewPicture {
 public:
  ViewPicture();
  ~ViewPicture();
  ViewPicture(const ViewPicture&) = delete;
  ViewPicture& operator=(const ViewPicture&) = delete;

  /// Draws at a quality; `settings` gives the full size. Waits for the driver to finish.
  /// With a wipe the renderer is left with the right state.
  /// gives: time taken, ms. throws: MachineError when the driver cannot make a picture of this
  /// size.
  double draw(SceneRenderer& renderer, const Camera& camera, PictureSettings settings,
              const Quality& quality, const std::optional<Wipe>& wipe = {});

  /// GL texture, its first row at the bottom, opaque; 0 before the first picture.
  unsigned texture() const;
  /// Samples that the context gave.
  int samples() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
