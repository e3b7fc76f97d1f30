#include "render/image/raster_2d.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

Eigen::Vector3f divider_of(Backdrop backdrop) {
  return Eigen::Vector3f::Constant(backdrop == Backdrop::light ? 0.25f : 0.93f);
}

}  // namespace

void lay_over(std::uint8_t* pixel, const Eigen::Vector3f& color, float cover) {
  const float below = (1 - cover) * static_cast<float>(pixel[3]) / 255, all = cover + below;
  if (!(all > 0)) return;
  const float fraction = pixel[3] == 255 ? cover : cover / all;
  for (int k = 0; k < 3; ++k)
    pixel[k] = static_cast<std::uint8_t>(
        std::lround(fraction * 255 * color[k] + (1 - fraction) * static_cast<float>(pixel[k])));
  pixel[3] = static_cast<std::uint8_t>(std::lround(255 * all));
}

void shade_box(Image& image, const PixelBox& box, const Eigen::Vector3f& color, float cover) {
  for (int y = std::max(0, box.y0); y < std::min(image.height, box.y1); ++y)
    for (int x = std::max(0, box.x0); x < std::min(image.width, box.x1); ++x)
      lay_over(&image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)], color, cover);
}

void paint_box(Image& image, const PixelBox& box, const Eigen::Vector3f& color) {
  shade_box(image, box, color, 1);
}

void paint_frame(Image& image, const PixelBox& b, const Eigen::Vector3f& color, int width) {
  paint_box(image, {b.x0 - width, b.y0 - width, b.x1 + width, b.y0}, color);
  paint_box(image, {b.x0 - width, b.y1, b.x1 + width, b.y1 + width}, color);
  paint_box(image, {b.x0 - width, b.y0, b.x0, b.y1}, color);
  paint_box(image, {b.x1, b.y0, b.x1 + width, b.y1}, color);
}

void stroke(Image& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius,
            const Eigen::Vector3f& color) {
  const Eigen::Vector2d along = to - from;
  const Eigen::Vector2d low = from.cwiseMin(to).array() - radius - 1;
  const Eigen::Vector2d high = from.cwiseMax(to).array() + radius + 1;
  for (int y = std::max(0, static_cast<int>(low.y())); y <= high.y(); ++y)
    for (int x = std::max(0, static_cast<int>(low.x())); x <= high.x(); ++x) {
      const Eigen::Vector2d p(x + 0.5, y + 0.5);
      const double t =
          std::clamp((p - from).dot(along) / std::max(along.squaredNorm(), 1e-9), 0.0, 1.0);
      const double cover = std::clamp(radius + 0.5 - (p - from - t * along).norm(), 0.0, 1.0);
      if (cover > 0) shade_box(image, {x, y, x + 1, y + 1}, color, static_cast<float>(cover));
    }
}

Image wiped(const Image& left, const Image& right, double at, Backdrop backdrop) {
  Image image = right;
  const int border = static_cast<int>(std::lround(std::clamp(at, 0.0, 1.0) * image.width));
  for (int y = 0; y < image.height; ++y) {
    const std::size_t row = std::size_t{4} * y * image.width;
    std::copy_n(&left.rgba[row], 4 * static_cast<std::size_t>(border), &image.rgba[row]);
  }
  const int half = std::max(1, image.height / 720);
  paint_box(image, {border - half, 0, border + half, image.height}, divider_of(backdrop));
  return image;
}

Image beside(std::span<const Image> images, Backdrop backdrop) {
  Image whole;
  const int width = images.front().width, count = static_cast<int>(images.size());
  whole.width = count * width;
  whole.height = images.front().height;
  whole.rgba.resize(std::size_t{4} * whole.width * whole.height);
  const int half = std::max(1, whole.height / 720);
  for (int i = 0; i < count; ++i)
    for (int y = 0; y < whole.height; ++y)
      std::copy_n(&images[i].rgba[std::size_t{4} * y * width], std::size_t{4} * width,
                  &whole.rgba[std::size_t{4} * (std::size_t{1} * y * whole.width + i * width)]);
  for (int i = 1; i < count; ++i)
    paint_box(whole, {i * width - half, 0, i * width + half, whole.height}, divider_of(backdrop));
  return whole;
}

}  // namespace condyle
