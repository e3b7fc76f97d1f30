#include "engine/gltf/shape_keys.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Shapes = std::vector<std::vector<Eigen::Vector3f>>;

/// Largest squared distance of the frames between two keys from the straight line between them.
float squared_error(const Shapes& shapes, const std::vector<double>& times_s, std::size_t a,
                    std::size_t b, float enough) {
  float worst = 0;
  for (std::size_t f = a + 1; f < b; ++f) {
    const auto s = static_cast<float>((times_s[f] - times_s[a]) / (times_s[b] - times_s[a]));
    for (std::size_t v = 0; v < shapes[f].size(); ++v) {
      const Eigen::Vector3f between = shapes[a][v] + s * (shapes[b][v] - shapes[a][v]);
      worst = std::max(worst, (shapes[f][v] - between).squaredNorm());
    }
    if (worst > enough) break;
  }
  return worst;
}

}  // namespace

ShapeKeys choose_shape_keys(const Shapes& shapes, const std::vector<double>& times_s,
                            double error_mm) {
  ShapeKeys keys;
  if (shapes.empty()) return keys;
  keys.frames = {0};
  if (std::all_of(shapes.begin(), shapes.end(),
                  [&](const auto& shape) { return shape == shapes.front(); }))
    return keys;
  const auto allowed = static_cast<float>(error_mm * error_mm);
  while (keys.frames.back() + 1 < shapes.size()) {
    const std::size_t from = keys.frames.back();
    std::size_t to = from + 1;
    float error = 0;
    while (to + 1 < shapes.size()) {
      const float longer = squared_error(shapes, times_s, from, to + 1, allowed);
      if (longer > allowed) break;
      error = longer;
      ++to;
    }
    keys.frames.push_back(to);
    keys.error_mm = std::max(keys.error_mm, std::sqrt(static_cast<double>(error)));
  }
  return keys;
}

}  // namespace condyle
