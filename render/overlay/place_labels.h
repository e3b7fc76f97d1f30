#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "render/camera/camera.h"
#include "render/image/backdrop.h"
#include "render/image/glyphs.h"
#include "render/image/image.h"
#include "render/overlay/overlays.h"

namespace condyle {

/// A label in a picture, pixels from its top left.
struct PlacedLabel {
  std::string words;
  Eigen::Vector2d place;   // that it names
  Eigen::Vector2d corner;  // upper left of its words
  double width = 0;        // of its words
};

/// Labels of the nearer half of the places, to the side of each, without overlaps; those without
/// space are left out. `row_px`: their height; `width_of`: of words, pixels.
std::vector<PlacedLabel> placed_labels(std::span<const PlaceLabel> labels, const Camera& camera,
                                       const Eigen::Vector2d& picture_px, double row_px,
                                       const std::function<double(const std::string&)>& width_of);

/// Writes them, scaled by the picture's height, each with a line to its place. Nothing without a
/// system font.
void draw_labels(Image& image, const Glyphs& words, const Camera& camera,
                 std::span<const PlaceLabel> labels, Backdrop backdrop = Backdrop::dark);

}  // namespace condyle
