#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "render/image/image.h"

namespace condyle {

/// A coloured word under the pictures.
struct ColourKey {
  Eigen::Vector3f color;  // sRGB, 0 to 1
  std::string text;
};

/// Pictures of one size in rows and columns on a white sheet, with a title, a heading above each
/// picture and keys and lines of text below.
struct PictureGrid {
  std::string title;
  struct Panel {
    Image image;
    std::string heading;
  };
  std::vector<std::vector<Panel>> rows;  // of equal length
  std::vector<ColourKey> keys = {};
  std::vector<std::string> lines = {};
};

/// Without a system font the sheet has no text.
Image draw_grid(const PictureGrid& grid);

}  // namespace condyle
