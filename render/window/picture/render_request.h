#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/camera/camera.h"
#include "render/scene/scene_renderer.h"
#include "render/scene/shown_overlays.h"
#include "render/window/picture/map_surface.h"
#include "render/window/picture/quality.h"
#include "sim/frame/before_operation.h"
#include "sim/frame/frame_state.h"

namespace condyle {

/// The patient to upload.
struct DrawnParts {
  std::span<const Part> parts = {};
  std::optional<ColourMap> colours = {};
  std::shared_ptr<const BeforeOperation> operation = {};  // after which they are shown
  std::shared_ptr<const void> keeper = {};                // keeps the parts alive
};

/// Finer surfaces of parts, for colours by values.
struct DrawnMap {
  std::vector<MapSurface> surfaces = {};
  std::shared_ptr<const void> keeper = {};  // keeps the surfaces alive
};

/// The content of one picture. Large data is shared and immutable: other data has another pointer.
struct RenderRequest {
  std::shared_ptr<const DrawnParts> parts = {};   // none: nothing is drawn
  std::shared_ptr<const FrameState> frame = {};   // none: at rest
  std::shared_ptr<const FrameState> beside = {};  // left of a wipe; none: no wipe
  double wipe_at = 0.5;                           // fraction of the width
  bool before_is_beside = false;                 // the state beside is the one before the operation
  std::shared_ptr<const DrawnMap> map = {};      // none: the parts' own surfaces
  std::shared_ptr<const MapValues> values = {};  // of the map's surfaces; none: no colours
  std::shared_ptr<const MapValues> beside_values = {};  // the same of the state beside
  bool displacement = false;                      // the face coloured by its displacement from rest
  std::shared_ptr<const Overlays> overlays = {};  // none: the parts alone
  Camera camera = {};
  PictureSettings settings = {};
  Quality quality = {};
  bool moving = false;  // returned with the picture, as is:
  long number = 0;      // of the request
};

/// A finished picture: opaque 8-bit RGBA, rows from the bottom, as in OpenGL.
struct DrawnPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba = {};
  std::shared_ptr<const DrawnParts> parts = {};  // the patient that it shows
  Quality quality = {};
  int samples = 1;  // provided by the context
  bool moving = false;
  long number = 0;  // of its request
  double ms = 0;    // drawing time
};

}  // namespace condyle
