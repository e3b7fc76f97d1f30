#pragma once

#include "render/annotations.h"
#include "render/scene_renderer.h"
#include "sim/case/case.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/overlay_drawing.h"

namespace condyle {

/// What is drawn in each picture of a recording.
struct PicturePlan {
  PictureSettings settings;
  OverlayChoice overlays;
  Annotations annotations;  // without captions
  SurfaceMap map = SurfaceMap::none;
  bool patches = false;
  std::optional<double> wipe = std::nullopt;
  bool before_after = false;
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
