#include "render/overlay/place_labels.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/image/raster_2d.h"
#include "render/image/text_panel_colours.h"

namespace condyle {
namespace {

using Eigen::Vector2d;

struct Candidate {
  const PlaceLabel* label;
  Vector2d place;
  double away;  // from the eye
};

std::vector<Candidate> nearer_half(std::span<const PlaceLabel> labels, const Camera& camera,
                                   const Vector2d& picture_px) {
  constexpr double near_mm = 1, far_mm = 1e5, tolerance_mm = 3;
  const Eigen::Matrix4f to_clip =
      projection_matrix(camera, picture_px.x() / picture_px.y(), near_mm, far_mm) *
      view_matrix(camera);
  std::vector<Candidate> found;
  double mean = 0;
  for (const PlaceLabel& label : labels) {
    const Eigen::Vector4d p = (to_clip * label.place.homogeneous()).cast<double>();
    mean += p.w() / static_cast<double>(labels.size());
    if (p.w() <= near_mm) continue;
    found.push_back(
        {&label,
         0.5 * Vector2d((1 + p.x() / p.w()) * picture_px.x(), (1 - p.y() / p.w()) * picture_px.y()),
         p.w()});
  }
  std::erase_if(found, [&](const Candidate& c) { return c.away > mean + tolerance_mm; });
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.away < b.away; });
  return found;
}

}  // namespace

std::vector<PlacedLabel> placed_labels(std::span<const PlaceLabel> labels, const Camera& camera,
                                       const Vector2d& picture_px, double row_px,
                                       const std::function<double(const std::string&)>& width_of) {
  const double aside = 2.5 * row_px, gap = 0.35 * row_px;
  const auto candidates = nearer_half(labels, camera, picture_px);
  double middle = 0;
  for (const Candidate& c : candidates)
    middle += c.place.x() / static_cast<double>(candidates.size());
  std::vector<PlacedLabel> placed;
  const auto is_free = [&](const Vector2d& corner, double width) {
    if (corner.x() < 0 || corner.y() < 0 || corner.x() + width > picture_px.x() ||
        corner.y() + row_px > picture_px.y())
      return false;
    return std::none_of(placed.begin(), placed.end(), [&](const PlacedLabel& other) {
      return corner.x() < other.corner.x() + other.width + gap &&
             other.corner.x() < corner.x() + width + gap &&
             std::abs(corner.y() - other.corner.y()) < row_px + gap;
    });
  };
  for (const Candidate& c : candidates) {
    const double width = width_of(c.label->words);
    const double x = c.place.x() < middle ? c.place.x() - aside - width : c.place.x() + aside;
    for (const int row : {0, -1, 1, -2, 2, -3, 3, -4, 4}) {
      const Vector2d corner(x, c.place.y() + (row * 1.4 - 0.5) * row_px);
      if (!is_free(corner, width)) continue;
      placed.push_back({c.label->words, c.place, corner, width});
      break;
    }
  }
  return placed;
}

void draw_labels(Image& image, const Glyphs& words, const Camera& camera,
                 std::span<const PlaceLabel> labels, Backdrop backdrop) {
  if (labels.empty() || !words.has_font()) return;
  const double scale = std::clamp(image.height / 720.0, 0.4, 8.0), letters = 14 * scale,
               row = 18 * scale;
  const TextPanelColours colours = text_panel_colours(backdrop);
  const auto px = [](double v) { return static_cast<int>(std::lround(v)); };
  for (const PlacedLabel& label :
       placed_labels(labels, camera, {image.width, image.height}, row,
                     [&](const std::string& text) { return words.width(text, letters); })) {
    const bool left = label.corner.x() < label.place.x();
    const Vector2d end(label.corner.x() + (left ? label.width + 3 * scale : -3 * scale),
                       label.corner.y() + 0.5 * row);
    stroke(image, label.place, end, 0.7 * scale, colours.words);
    stroke(image, label.place, label.place, 2 * scale, colours.words);
    shade_box(image,
              {px(label.corner.x() - 3 * scale), px(label.corner.y()),
               px(label.corner.x() + label.width + 3 * scale), px(label.corner.y() + row)},
              colours.ground, colours.cover);
    words.write(image, label.corner.x(), label.corner.y() + 0.75 * row, letters, label.words,
                colours.words);
  }
}

}  // namespace condyle
