#pragma once

#include "render/image/colour_map.h"

namespace condyle {

/// Gap to the opposing teeth, mm, from -0.1 to 1: dark red where film of that thickness is marked,
/// then yellow to pale; grey beyond. Distinguishable by lightness alone. source: ColorBrewer
/// YlOrRd.
ColourMap gap_colours(double film_mm);

/// The same up to where the film is marked: contact patches only.
ColourMap patch_colours(double film_mm);

}  // namespace condyle
