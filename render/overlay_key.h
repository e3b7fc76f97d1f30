#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "render/backdrop.h"
#include "render/image.h"
#include "render/lettering.h"
#include "render/overlays.h"
#include "render/paint.h"

namespace condyle {

/// One line of the key to what is drawn beside the surfaces: a mark as it looks there, and what it
/// is. The mark's shape tells apart what has the same colour.
struct KeyEntry {
  enum class Mark { line, path, arrow, sheet, scale };
  std::string words;
  // sRGB. Of a path the line's and the dot's at its end; of a scale from the first to the last.
  std::vector<Eigen::Vector3f> colors;
  Mark mark = Mark::line;
};

/// What a ghost is.
KeyEntry ghost_key(const Ghost& ghost);

/// Colour at a share of the mark's width.
Eigen::Vector3f color_of(const KeyEntry& entry, double share);

/// The key on a pane in the picture's upper left corner, sized by the picture; above the
/// legend of a map. gives: the pane; an empty one where there is nothing to tell, no font or no
/// room.
PixelBox add_key(Image& image, const Lettering& words, std::span<const KeyEntry> key,
                 Backdrop backdrop = Backdrop::dark);

}  // namespace condyle
