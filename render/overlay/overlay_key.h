#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "render/image/backdrop.h"
#include "render/image/glyphs.h"
#include "render/image/image.h"
#include "render/image/raster_2d.h"
#include "render/overlay/overlays.h"

namespace condyle {

/// One entry of the key to the overlays: a mark as drawn, and its meaning. The mark's shape
/// distinguishes entries of the same colour.
struct KeyEntry {
  enum class Mark { line, path, arrow, sheet, scale };
  std::string words;
  // sRGB. For a path the colours of the line and of the dot at its end; for a scale from the first
  // to the last.
  std::vector<Eigen::Vector3f> colors;
  Mark mark = Mark::line;
};

/// The entry for ghosts.
KeyEntry ghost_key(const Ghost& ghost);

/// Colour at a fraction of the mark's width.
Eigen::Vector3f color_of(const KeyEntry& entry, double fraction);

/// The key on a panel in the picture's upper left corner, scaled by the picture; above the legend
/// of a map. Returns the panel; an empty one without entries, font or space.
PixelBox add_key(Image& image, const Glyphs& words, std::span<const KeyEntry> key,
                 Backdrop backdrop = Backdrop::dark);

}  // namespace condyle
