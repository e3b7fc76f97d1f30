#pragma once

#include "render/colour_map.h"

namespace condyle {

/// Gap to the opposing teeth, mm, from -0.1 to 1: dark red where paper of that thickness is marked,
/// then yellow to pale; grey beyond. Told apart with every kind of colour vision by lightness
/// alone. source: ColorBrewer YlOrRd.
ColourMap gap_colours(double paper_mm);

/// The same up to where the paper is marked: patches of contact, and nothing else.
ColourMap patch_colours(double paper_mm);

}  // namespace condyle
