#include "render/overlay/annotations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/image/raster_2d.h"
#include "render/image/text_panel_colours.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// Letters with a border are readable on skin and on the background.
struct LabelColours {
  Vector3f letters, border;
  double line_border_px;  // of the cross's bright lines
};
const LabelColours on_dark = {Vector3f::Constant(0.96f), Vector3f::Constant(0.05f), 0},
                   on_light = {Vector3f::Constant(0.10f), Vector3f::Constant(0.97f), 0.8};

Eigen::Matrix3d rows_of(const Camera& camera) {
  return view_matrix(camera).topLeftCorner<3, 3>().cast<double>();
}

void write(Image& image, const Glyphs& words, const LabelColours& colours, double x, double y,
           double height, const std::string& text) {
  const double off = std::max(1.0, height / 14);
  for (const double dx : {-off, 0.0, off})
    for (const double dy : {-off, 0.0, off})
      if (dx != 0 || dy != 0) words.write(image, x + dx, y + dy, height, text, colours.border);
  words.write(image, x, y, height, text, colours.letters);
}

void write_centred(Image& image, const Glyphs& words, const LabelColours& colours, double x,
                   double y, double height, const std::string& text) {
  write(image, words, colours, x - words.width(text, height) / 2, y, height, text);
}

/// Height of letters.
double unit_of(const Image& image) { return std::max(10.0, image.height / 45.0); }

void draw_bar(Image& image, const Glyphs& words, const LabelColours& colours, const Camera& camera,
              double unit) {
  const ScaleBar bar = scale_bar(camera, image.height, image.width);
  const int right = static_cast<int>(image.width - 2.2 * unit);
  const int left = right - static_cast<int>(std::lround(bar.pixels));
  const int low = static_cast<int>(image.height - 2.2 * unit), thick = std::max(2, int(unit / 6));
  const int tick = std::max(4, static_cast<int>(unit / 3));
  for (const PixelBox& box : {PixelBox{left, low - thick, right, low},
                              PixelBox{left, low - tick - thick, left + thick, low},
                              PixelBox{right - thick, low - tick - thick, right, low}})
    paint_frame(image, box, colours.border), paint_box(image, box, colours.letters);
  paint_box(image, {left, low - thick, right, low}, colours.letters);
  write_centred(image, words, colours, 0.5 * (left + right), low - tick - 0.6 * unit, unit,
                bar.text);
}

/// Position of text at the picture's centre: beside a line that would cross it.
double middle_of(const Image& image, double width, double unit, std::optional<double> line_at) {
  const double middle = image.width / 2.0, line = line_at.value_or(-1) * image.width;
  const double least = width / 2 + 0.6 * unit;
  if (std::abs(middle - line) >= least) return middle;
  return line <= middle ? line + least : line - least;
}

void draw_letters(Image& image, const Glyphs& words, const LabelColours& colours,
                  const Camera& camera, double unit, const Annotations& annotations) {
  const auto [left, right, top, bottom] = edge_letters(camera);
  const double size = 1.5 * unit, middle = image.height / 2.0 + 0.35 * size;
  write_centred(image, words, colours, std::max(1.6 * unit, annotations.taken_left + unit), middle,
                size, {left});
  write_centred(image, words, colours, image.width - 1.6 * unit, middle, size, {right});
  const auto centred = [&](char letter, double y) {
    const double wide = words.width({letter}, size);
    write_centred(image, words, colours, middle_of(image, wide, unit, annotations.line_at), y, size,
                  {letter});
  };
  centred(top, 2.2 * unit);
  centred(bottom, image.height - 1.2 * unit);

  // Okabe-Ito vermilion, bluish green and sky blue; the letters do not rely on colour.
  const double reach = 3.2 * unit;
  const Vector2d cross(image.width - reach - 2.2 * unit, reach + 2.2 * unit);
  for (const auto& axis : axis_letters(camera)) {
    const bool positive = axis.letter == 'L' || axis.letter == 'P' || axis.letter == 'S';
    const Vector3f color = axis.letter == 'L' || axis.letter == 'R'   ? Vector3f(.90f, .45f, .10f)
                           : axis.letter == 'A' || axis.letter == 'P' ? Vector3f(.10f, .68f, .52f)
                                                                      : Vector3f(.40f, .75f, .95f);
    if (!positive) continue;  // the end of its line
    const Vector2d end = cross + reach * Vector2d(axis.direction.x(), -axis.direction.y());
    const double thick = std::max(1.0, unit / 9);
    if (colours.line_border_px > 0)
      stroke(image, cross, end, thick + colours.line_border_px, line_border);
    stroke(image, cross, end, thick, color);
    if (axis.toward_eye >= -0.9)
      write_centred(image, words, colours, end.x(), end.y() + 0.35 * unit, 0.95 * unit,
                    {axis.letter});
  }
}

}  // namespace

ScaleBar scale_bar(const Camera& camera, int height_px, int width_px, double fraction) {
  const double pixels_per_mm =
      height_px / 2.0 /
      (camera.distance_mm * std::tan(camera.field_of_view_deg * std::numbers::pi / 360));
  const double max_mm = fraction * width_px / pixels_per_mm;
  const double power = std::pow(10, std::floor(std::log10(max_mm)));
  const double digit = max_mm / power >= 5 ? 5 : max_mm / power >= 2 ? 2 : 1;
  ScaleBar bar;
  bar.length_mm = digit * power;
  bar.pixels = bar.length_mm * pixels_per_mm;
  bar.text = fmt::format("{:g} mm", bar.length_mm);
  return bar;
}

std::array<AxisLetter, 6> axis_letters(const Camera& camera) {
  const Eigen::Matrix3d rows = rows_of(camera);
  std::array<AxisLetter, 6> letters;
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {1, -1}) {
      const Vector3d seen = sign * rows.col(axis);
      const int i = 2 * axis + (sign < 0);
      letters[static_cast<std::size_t>(i)] = {"LRPASI"[i], seen.head<2>(), seen.z()};
    }
  std::stable_sort(letters.begin(), letters.end(), [](const AxisLetter& a, const AxisLetter& b) {
    return a.toward_eye < b.toward_eye;
  });
  return letters;
}

EdgeLetters edge_letters(const Camera& camera) {
  const Eigen::Matrix3d rows = rows_of(camera);
  const auto letter = [](const Vector3d& direction) {
    Eigen::Index axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    return "LRPASI"[2 * axis + (direction[axis] < 0)];
  };
  const Vector3d right = rows.row(0), up = rows.row(1);
  return {letter(-right), letter(right), letter(up), letter(-up)};
}

void keep_clear_of(Annotations& annotations, const PixelBox& pane, const Image& image) {
  const double middle = image.height / 2.0, half = 1.2 * unit_of(image);
  if (pane.x0 < 2.5 * unit_of(image) && pane.y0 < middle + half && pane.y1 > middle - half)
    annotations.taken_left = std::max(annotations.taken_left, pane.x1);
}

void annotate(Image& image, const Glyphs& words, const Camera& camera,
              const Annotations& annotations) {
  const double unit = unit_of(image);
  const LabelColours& colours = annotations.backdrop == Backdrop::light ? on_light : on_dark;
  if (annotations.letters) draw_letters(image, words, colours, camera, unit, annotations);
  if (annotations.scale_bar) draw_bar(image, words, colours, camera, unit);
  const double below = annotations.letters ? 3.2 * unit : 1.6 * unit;
  const auto count = static_cast<double>(annotations.caption.size());
  for (std::size_t i = 0; i < annotations.caption.size(); ++i)
    write_centred(image, words, colours,
                  middle_of(image, words.width(annotations.caption[i], 1.1 * unit), unit,
                            annotations.line_at),
                  image.height - below - 1.4 * unit * (count - 1 - static_cast<double>(i)),
                  1.1 * unit, annotations.caption[i]);
}

}  // namespace condyle
