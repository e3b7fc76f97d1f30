#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/backdrop.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/lettering.h"
#include "render/paint.h"

namespace condyle {

/// A round length that is seen some `share` of the picture's width wide at the camera's target.
struct ScaleBar {
  double length_mm = 0;  // 1, 2 or 5 times a power of ten
  double pixels = 0;     // across the line of sight through the target
  std::string text;      // "20 mm"
};
ScaleBar scale_bar(const Camera& camera, int height_px, int width_px, double share = 0.18);

/// Where a letter of the patient's axes (L R A P S I) points in the picture.
struct AxisLetter {
  char letter;
  Eigen::Vector2d direction;  // right and up, length 1 across the line of sight, 0 along it
  double toward_eye;          // -1 to 1
};
/// The six of them, the farthest first.
std::array<AxisLetter, 6> axis_letters(const Camera& camera);

/// The letters that stand at the picture's left, right, top and bottom edges.
struct EdgeLetters {
  char left, right, top, bottom;
};
EdgeLetters edge_letters(const Camera& camera);

/// What is written on a finished picture.
struct Annotations {
  bool scale_bar = false;
  bool letters = false;  // at the edges, and a cross of axes in the upper right corner
  Backdrop backdrop = Backdrop::dark;
  int taken_left = 0;  // of the left edge's middle, pixels: the letter stands beside it
  std::optional<double> line_at = {};     // of an upright line, share of the width: beside it
  std::vector<std::string> caption = {};  // lines at the bottom, in the middle
};

/// Keeps the letters clear of a pane at the left edge.
void keep_clear_of(Annotations& annotations, const PixelBox& pane, const Image& image);

/// Paints them, sized by the picture's height. Without a font of the system the bar and the cross
/// alone.
void annotate(Image& image, const Lettering& words, const Camera& camera,
              const Annotations& annotations);

}  // namespace condyle
