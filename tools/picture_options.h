#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/annotations.h"
#include "render/recording_sheet.h"
#include "render/scene_renderer.h"
#include "render/shown_overlays.h"
#include "sim/case/case.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/overlay_drawing.h"

namespace condyle {

/// What a window that is recorded from has of its own.
struct WindowPicture {
  Camera camera = {};                                  // `own_camera` and `turning_camera`
  Eigen::Vector3d upright = {0, 0, 1};                 // what the latter turns about
  std::shared_ptr<const FrameState> before = nullptr;  // left of a wipe; none: the patient at rest
  std::function<Overlays(const FrameState&)> overlays = {};  // instead of those by name
};

/// What is drawn in each picture of a recording.
struct PicturePlan {
  PictureSettings settings;
  OverlayChoice overlays;
  Annotations annotations;  // without captions
  SurfaceMap map = SurfaceMap::none;
  bool patches = false;
  std::optional<double> wipe = std::nullopt;
  bool before_after = false;
  double near_mm = 2;  // end of the map of distances
  std::string caption = {};
  std::vector<std::string> cameras = {"three-quarter"};
  std::optional<WindowPicture> window = std::nullopt;  // none: of a command line
  RecordingSheet words = {};                           // what it says, for the recording's sheet
};

/// throws: InputError saying which option is wrong and what is known.
PicturePlan parse_pictures(const PictureOptions& options, const Case& patient);

/// What needs no patient to be wrong.
void check_pictures(const PictureOptions& options);

/// All that decides the pictures but size and camera, for a recording's sheet.
std::string describe(const PictureOptions& options);

/// The caption's lines with what is in braces filled in. throws: InputError for unknown braces.
std::vector<std::string> caption_lines(const std::string& caption, int frame,
                                       const FrameState& state, const std::string& motion);

}  // namespace condyle
