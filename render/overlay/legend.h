#pragma once

#include <string>
#include <vector>

#include "render/image/backdrop.h"
#include "render/image/colour_map.h"
#include "render/image/glyphs.h"
#include "render/image/image.h"
#include "render/image/raster_2d.h"

namespace condyle {

/// Position of a legend in a picture, pixels, and its style.
struct LegendLayout {
  int left = 0, top = 0;
  int bar_width = 26, bar_height = 384;
  double letters = 18;  // height
  Eigen::Vector3f ink = Eigen::Vector3f::Constant(0.13f), faint = Eigen::Vector3f::Constant(0.35f);
};

/// Height of the whole legend, from its title to the patch for values beyond the range.
int legend_height(const LegendLayout& layout);

/// The colour bar with ticks, the bands' names and the colour beyond. Title and unit on top.
void draw_legend(Image& image, const Glyphs& words, const ColourMap& map,
                 const LegendLayout& layout);

/// The legend on a panel in the picture's lower left corner, scaled by the picture, with remarks
/// under it. Without a system font only the bar. Returns the panel.
PixelBox add_legend(Image& image, const Glyphs& words, const ColourMap& map,
                    const std::vector<std::string>& remarks = {},
                    Backdrop backdrop = Backdrop::dark);

}  // namespace condyle
