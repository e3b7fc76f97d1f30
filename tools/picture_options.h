#pragma once

#include <optional>
#include <string>

#include "render/recording/picture_plan.h"
#include "sim/case/case.h"

namespace CLI {
class App;
}

namespace condyle {

/// What is cut, laid over and written on pictures, as the user wrote it.
struct PictureOptions {
  std::string size = "1280x720";
  std::string camera = "three-quarter";  // several by commas
  std::string show = "all";
  double distance_near_mm = 2;  // end of the map of distances
  std::string clip = {}, clip_parts = {}, cut_away = {}, overlay = {};
  bool clip_open = false;
  std::optional<double> wipe = std::nullopt;
  bool before_after = false;
  std::string caption = {};
  bool transparent = false, light = false;
  std::string edges = "msaa4";
  int supersample = 1;
  bool shadows = true;
};

/// The groups "Camera" and "Look".
void add_pictures(CLI::App& command, PictureOptions& picture);

/// throws: InputError saying which option is wrong and what is known.
PicturePlan parse_pictures(const PictureOptions& options, const Case& patient);

/// What needs no patient to be wrong.
void check_pictures(const PictureOptions& options);

/// All that decides the pictures but size and camera, for a recording's sheet.
std::string describe(const PictureOptions& options);

}  // namespace condyle
