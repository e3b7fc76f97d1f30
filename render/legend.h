#pragma once

#include <string>
#include <vector>

#include "render/backdrop.h"
#include "render/colour_map.h"
#include "render/image.h"
#include "render/lettering.h"
#include "render/paint.h"

namespace condyle {

/// Where a legend stands in a picture, pixels, and how it looks.
struct LegendPlace {
  int left = 0, top = 0;
  int bar_width = 26, bar_height = 384;
  double letters = 18;  // height
  Eigen::Vector3f ink = Eigen::Vector3f::Constant(0.13f), faint = Eigen::Vector3f::Constant(0.35f);
};

/// Height of the whole legend, from its title to the patch of what lies beyond the range.
int legend_height(const LegendPlace& place);

/// The colour bar with ticks, the bands' names and the colour beyond. Title and unit on top.
void draw_legend(Image& image, const Lettering& words, const ColourMap& map,
                 const LegendPlace& place);

/// The legend on a pane in the picture's lower left corner, sized by the picture, with remarks
/// under it. Without a font of the system the bar alone. gives: the pane.
PixelBox add_legend(Image& image, const Lettering& words, const ColourMap& map,
                    const std::vector<std::string>& remarks = {},
                    Backdrop backdrop = Backdrop::dark);

}  // namespace condyle
