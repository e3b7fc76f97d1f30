#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/camera/camera.h"
#include "render/image/backdrop.h"
#include "render/image/glyphs.h"
#include "render/image/image.h"
#include "render/image/raster_2d.h"

namespace condyle {

/// A round length that appears about `fraction` of the picture's width wide at the camera's target.
struct ScaleBar {
  double length_mm = 0;  // 1, 2 or 5 times a power of ten
  double pixels = 0;     // across the line of sight through the target
  std::string text;      // "20 mm"
};
ScaleBar scale_bar(const Camera& camera, int height_px, int width_px, double fraction = 0.18);

/// Direction of a letter of the patient's axes (L R A P S I) in the picture.
struct AxisLetter {
  char letter;
  Eigen::Vector2d direction;  // right and up, length 1 across the line of sight, 0 along it
  double toward_eye;          // -1 to 1
};
/// All six, the farthest first.
std::array<AxisLetter, 6> axis_letters(const Camera& camera);

/// The letters at the picture's left, right, top and bottom edges.
struct EdgeLetters {
  char left, right, top, bottom;
};
EdgeLetters edge_letters(const Camera& camera);

/// Text on a finished picture.
struct Annotations {
  bool scale_bar = false;
  bool letters = false;  // at the edges, and a cross of axes in the upper right corner
  Backdrop backdrop = Backdrop::dark;
  // occupied at the middle of the left edge, pixels: the letter is moved beside it
  int taken_left = 0;
  // of a vertical line, fraction of the width: letters are beside it
  std::optional<double> line_at = {};
  std::vector<std::string> caption = {};  // lines at the bottom, centred
};

/// Keeps the letters clear of a panel at the left edge.
void keep_clear_of(Annotations& annotations, const PixelBox& pane, const Image& image);

/// Draws them, scaled by the picture's height. Without a system font only the bar and the cross.
void annotate(Image& image, const Glyphs& words, const Camera& camera,
              const Annotations& annotations);

}  // namespace condyle
