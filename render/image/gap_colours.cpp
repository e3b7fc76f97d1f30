#include "render/image/gap_colours.h"

#include <algorithm>

namespace condyle {
namespace {

const Eigen::Vector3f overlap(0.30f, 0.0f, 0.10f), marked(0.70f, 0.0f, 0.15f);

}  // namespace

ColourMap gap_colours(double film_mm) {
  const auto paper = static_cast<float>(std::clamp(film_mm, 0.01, 0.5));
  const Eigen::Vector3f near(0.99f, 0.70f, 0.30f), far(1.0f, 1.0f, 0.88f);
  ColourMap map;
  map.title = "gap";
  map.unit = "mm";
  map.stops = {{-0.1f, overlap}, {0, overlap},           {0.001f, marked},
               {paper, marked},  {paper + 0.001f, near}, {1.0f, far}};
  map.ticks = {0, paper, 0.5f, 1};
  map.bands = {{0, paper, "marked"}, {paper, 1, "close"}};
  return map;
}

ColourMap patch_colours(double film_mm) {
  const auto paper = static_cast<float>(film_mm);
  ColourMap map;
  map.title = "gap";
  map.unit = "mm";
  map.stops = {{-paper, overlap}, {0, overlap}, {0.01f * paper, marked}, {paper, marked}};
  map.ticks = {-paper, 0, paper};
  map.bands = {{-paper, 0, "overlap"}, {0, paper, "contact"}};
  return map;
}

}  // namespace condyle
