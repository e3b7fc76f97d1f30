#include "render/image/colour_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

Eigen::Vector3f rgb(int code) {
  return Eigen::Vector3f(static_cast<float>(code >> 16 & 255), static_cast<float>(code >> 8 & 255),
                         static_cast<float>(code & 255)) /
         255;
}

}  // namespace

Eigen::Vector3f color_of(const ColourMap& map, float value) {
  const auto& stops = map.stops;
  if (!(value < map.high())) return map.beyond;
  if (value <= map.low()) return stops.front().color;
  const auto after = std::upper_bound(stops.begin(), stops.end(), value,
                                      [](float v, const auto& stop) { return v < stop.value; });
  const auto before = after - 1;
  const float s = (value - before->value) / (after->value - before->value);
  return before->color + s * (after->color - before->color);
}

ColourMap distance_colours(const DistanceBands& bands) {
  constexpr float edge = 0.05f;  // range over which white turns into a colour
  const auto near = static_cast<float>(bands.near_mm),
             deepest = static_cast<float>(bands.deepest_mm),
             contact = static_cast<float>(bands.contact_mm);
  const auto close =
      std::clamp(static_cast<float>(bands.close_mm), contact + 2 * edge, near - 2 * edge);
  ColourMap map;
  map.title = "distance";
  map.unit = "mm";
  map.stops = {
      {-deepest, rgb(0x67001f)}, {-0.5f * deepest, rgb(0xb2182b)}, {-contact - edge, rgb(0xe8604a)},
      {-contact, rgb(0xffffff)}, {contact, rgb(0xffffff)},         {contact + edge, rgb(0x1f5fa8)},
      {close, rgb(0x3576b6)},    {close + edge, rgb(0x83b7de)},    {near, rgb(0xc6dae6)}};
  map.beyond = rgb(0xb4b0a8);
  map.lines = {0};
  const float step = near + deepest > 4 ? 1 : 0.5f;
  for (float tick = -std::floor(deepest / step) * step; tick <= near + 1e-4f; tick += step)
    map.ticks.push_back(tick);
  map.bands = {{-deepest, -contact, "overlap"},
               {-contact, contact, fmt::format("contact \u00b1{:g}", bands.contact_mm)},
               {contact, close, "close"},
               {close, near, "near"}};
  return map;
}

ColourMap displacement_colours(double max_mm) {
  const auto most = static_cast<float>(max_mm);
  ColourMap map;
  map.title = "displacement";
  map.unit = "mm";
  const int codes[] = {0x440154, 0x414487, 0x2a788e, 0x22a884, 0x7ad151, 0xfde725};
  constexpr int last = 5;
  for (int i = 0; i <= last; ++i)
    map.stops.push_back({most * static_cast<float>(i) / last, rgb(codes[i])});
  // Not on the scale, distinguishable with every kind of colour vision.
  map.beyond = rgb(0x8c1a00);
  for (int i = 0; i <= last; ++i) map.ticks.push_back(most * static_cast<float>(i) / last);
  return map;
}

ColourMap deviation_colours(double most_mm, double tolerance_mm) {
  const auto most = static_cast<float>(most_mm), limit = static_cast<float>(tolerance_mm);
  ColourMap map;
  map.title = "deviation";
  map.unit = "mm";
  const int codes[] = {0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xf7f7f7,
                       0xf4a582, 0xd6604d, 0xb2182b, 0x67001f};
  for (int i = 0; i <= 8; ++i)
    map.stops.push_back({most * static_cast<float>(i - 4) / 4, rgb(codes[i])});
  map.beyond = rgb(0x8f8f88);
  map.lines = {-limit, limit};
  for (int i = -2; i <= 2; ++i) map.ticks.push_back(most * static_cast<float>(i) / 2);
  map.bands = {{-most, -limit, "behind"},
               {-limit, limit, fmt::format("within {:g}", tolerance_mm)},
               {limit, most, "in front"}};
  map.beyond_name = "not measured";
  return map;
}

}  // namespace condyle
