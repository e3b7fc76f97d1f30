#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "render/image/backdrop.h"
#include "render/image/image.h"

namespace condyle {

/// Pixels from (x0, y0) up to but excluding (x1, y1); pixels outside the image are clipped.
struct PixelBox {
  int x0, y0, x1, y1;
};

// Colours are sRGB, 0 to 1.
/// A colour blended over one pixel, straight RGBA; `cover` 0 changes nothing, 1 replaces it.
void lay_over(std::uint8_t* pixel, const Eigen::Vector3f& color, float cover);
void paint_box(Image& image, const PixelBox& box, const Eigen::Vector3f& color);
/// Fills the box with a colour; `cover` 0 changes nothing, 1 replaces the content.
void shade_box(Image& image, const PixelBox& box, const Eigen::Vector3f& color, float cover);
/// A frame of that width just outside the box.
void paint_frame(Image& image, const PixelBox& box, const Eigen::Vector3f& color, int width = 1);

/// A line of round, antialiased dots; pixels from the top left. Coincident ends give one dot.
void stroke(Image& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius,
            const Eigen::Vector3f& color);

/// Shows one image left of `at` (fraction of the width) and the other right of it, with a
/// separating line visible on the backdrop. Both have the same size.
Image wiped(const Image& left, const Image& right, double at, Backdrop backdrop = Backdrop::dark);

/// Side by side from left to right, with such a line between them; all of the same size.
Image beside(std::span<const Image> images, Backdrop backdrop = Backdrop::dark);

}  // namespace condyle
