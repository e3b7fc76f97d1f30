#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "render/backdrop.h"
#include "render/image.h"

namespace condyle {

/// Pixels from (x0, y0) up to but without (x1, y1); what lies outside of the image is left out.
struct PixelBox {
  int x0, y0, x1, y1;
};

// Colours are sRGB, 0 to 1.
/// A colour laid over one pixel, RGBA that is not premultiplied; `cover` 0 changes nothing, 1 hides
/// what is there.
void lay_over(std::uint8_t* pixel, const Eigen::Vector3f& color, float cover);
void paint_box(Image& image, const PixelBox& box, const Eigen::Vector3f& color);
/// The color laid over what is there; `cover` 0 changes nothing, 1 hides it.
void shade_box(Image& image, const PixelBox& box, const Eigen::Vector3f& color, float cover);
/// A line of that width just outside of the box.
void paint_frame(Image& image, const PixelBox& box, const Eigen::Vector3f& color, int width = 1);

/// A line of round dots, soft at the edge; pixels from the top left. One dot from a place to
/// itself.
void stroke(Image& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius,
            const Eigen::Vector3f& color);

/// Left of `at` (share of the width) the one, right of it the other, with a line between them that
/// is seen on the backdrop. Both of one size.
Image wiped(const Image& left, const Image& right, double at, Backdrop backdrop = Backdrop::dark);

/// From left to right, with such a line between them; all of one size.
Image beside(std::span<const Image> images, Backdrop backdrop = Backdrop::dark);

}  // namespace condyle
