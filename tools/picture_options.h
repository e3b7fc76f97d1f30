#pragma once

#include <optional>
#include <string>

#include "render/recording/picture_plan.h"
#include "sim/case/case.h"

namespace CLI {
class App;
}

namespace condyle {

/// Cuts, overlays and texts of pictures, unparsed.
struct PictureOptions {
  std::string size = "1280x720";
  std::string camera = "three-quarter";  // several separated by commas
  std::string show = "all";
  std::string shown_by = "--show";  // the option that gave `show`
  double distance_near_mm = 2;      // end of the map of distances
  std::string clip = {}, clip_parts = {}, cut_away = {}, overlay = {};
  bool clip_open = false;
  std::optional<double> wipe = std::nullopt;
  bool before_after = false;
  std::string caption = {};
  bool transparent = false, light = false;
  std::string edges = "msaa4";
  int supersample = 1;
  bool shadows = true;
  bool folds = true;
  bool life = false;
};

/// The groups "Camera" and "Look".
void add_pictures(CLI::App& command, PictureOptions& picture);

/// throws: InputError naming the wrong option and the known values.
PicturePlan parse_pictures(const PictureOptions& options, const Case& patient);

/// Checks that need no patient.
void check_pictures(const PictureOptions& options);

/// Everything that determines the pictures except size and camera, for a recording's sheet.
std::string describe(const PictureOptions& options);

}  // namespace condyle
