#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/output/recording_sheet.h"
#include "render/overlay/annotations.h"
#include "render/recording/overlay_drawing.h"
#include "render/scene/scene_renderer.h"
#include "render/scene/shown_overlays.h"
#include "sim/frame/before_operation.h"

namespace condyle {

/// Values that colour the surfaces.
enum class SurfaceMap { none, distance, displacement };

/// Data specific to a recording from a window.
struct WindowPicture {
  Camera camera = {};                                        // `own_camera` and `turning_camera`
  Eigen::Vector3d upright = {0, 0, 1};                       // axis of the latter
  std::function<Overlays(const FrameState&)> overlays = {};  // replace those by name
};

/// Content of each picture of a recording.
struct PicturePlan {
  PictureSettings settings;
  OverlayChoice overlays;
  Annotations annotations;  // without captions
  SurfaceMap map = SurfaceMap::none;
  bool patches = false;
  std::optional<double> wipe = std::nullopt;
  std::shared_ptr<const FrameState> before = nullptr;  // left of a wipe; null: the patient at rest
  std::shared_ptr<const BeforeOperation> operation = nullptr;  // if `before` is the state before it
  bool before_after = false;
  double near_mm = 2;  // end of the distance map
  std::string caption = {};
  std::vector<std::string> cameras = {"three-quarter"};
  std::optional<WindowPicture> window = std::nullopt;  // none: recorded from the command line
  RecordingSheet words = {};                           // its description for the recording's sheet
};

}  // namespace condyle
