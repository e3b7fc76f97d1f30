#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "render/gl/gl_context.h"
#include "render/scene/scene_renderer.h"
#include "tests/render/scene_parts.h"
#include "tests/support/picture.h"

namespace condyle {

/// Each test has its own context. EGL needs no device: Mesa renders on the CPU.
class WithContext : public testing::Test {
 protected:
  void SetUp() override { context_.emplace(); }

 private:
  std::optional<OffscreenContext> context_;
};

/// Small picture whose covered pixels are exactly those with alpha.
inline PictureSettings mask_settings(int side = 200) {
  PictureSettings settings;
  settings.width = settings.height = side;
  settings.transparent = true;
  return settings;
}

/// Area in pixels and centroid of the covered pixels, weighted by alpha.
struct Blob {
  double area = 0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
};
inline Blob blob_of(const Image& image) {
  Blob blob;
  Eigen::Vector2d square = Eigen::Vector2d::Zero();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double w = pixel(image, x, y).a / 255.0;
      const Eigen::Vector2d p(x + 0.5, y + 0.5);
      blob.area += w;
      blob.centre += w * p;
      square += w * p.cwiseProduct(p);
    }
  if (blob.area > 0) {
    blob.centre /= blob.area;
    blob.variance = square / blob.area - blob.centre.cwiseProduct(blob.centre);
  }
  return blob;
}

/// Roughness of the middle of a picture across and along, from second differences of its green.
inline std::pair<double, double> roughness(const Image& image) {
  constexpr int step = 3;
  double across = 0, along = 0;
  for (int y = image.height / 4; y < 3 * image.height / 4; ++y)
    for (int x = image.width / 4; x < 3 * image.width / 4; ++x) {
      const auto green = [&](int dx, int dy) { return double(pixel(image, x + dx, y + dy).g); };
      across += std::pow(green(-step, 0) - 2 * green(0, 0) + green(step, 0), 2);
      along += std::pow(green(0, -step) - 2 * green(0, 0) + green(0, step), 2);
    }
  return {across, along};
}

}  // namespace condyle
