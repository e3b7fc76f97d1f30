#include "render/colour_map.h"

#include <algorithm>

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

ColourMap distance_colours() {
  constexpr float contact = 0.1f, step = 0.02f;  // half the white band, and the width of its edge
  ColourMap map;
  map.title = "distance";
  map.unit = "mm";
  map.stops = {{-2, rgb(0x67001f)},
               {-1, rgb(0xb2182b)},
               {-0.5f, rgb(0xd6604d)},
               {-contact - step, rgb(0xf4a582)},
               {-contact, rgb(0xffffff)},
               {contact, rgb(0xffffff)},
               {contact + step, rgb(0xc6e0f0)},
               {1, rgb(0x92c5de)},
               {2, rgb(0x4393c3)},
               {3.5f, rgb(0x2166ac)},
               {5, rgb(0x1d4b85)}};
  map.lines = {0};
  map.ticks = {-2, -1, 0, 1, 2, 3, 4, 5};
  map.bands = {{-2, -contact, "overlap"},
               {-contact, contact, "contact"},
               {contact, 2, "near"},
               {2, 5, "far"}};
  return map;
}

}  // namespace condyle
