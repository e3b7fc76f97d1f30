#pragma once

#include <memory>

#include "render/camera.h"
#include "render/window/quality.h"

namespace condyle {

class SceneRenderer;
struct PictureSettings;

/// The last 3-D picture as a texture, so that panels can be redrawn without drawing the patient.
class ViewPicture {
 public:
  ViewPicture();
  ~ViewPicture();
  ViewPicture(const ViewPicture&) = delete;
  ViewPicture& operator=(const ViewPicture&) = delete;

  /// Draws at a quality; `settings` gives the full size. Waits for the driver to finish.
  /// gives: time taken, ms. throws: MachineError when the driver cannot make a picture of this
  /// size.
  double draw(SceneRenderer& renderer, const Camera& camera, PictureSettings settings,
              const Quality& quality);

  /// GL texture, its first row at the bottom, opaque; 0 before the first picture.
  unsigned texture() const;
  /// Samples that the context gave.
  int samples() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
