#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "engine/core/error.h"
#include "engine/tissue/layered_mesh.h"

namespace condyle {

LayerStack default_layers(int count) {
  const LayerMaterial outer{0.040}, middle{0.015}, inner{0.025};
  switch (count) {
    case 1:
      return {{1.0}, {inner}};
    case 2:
      return {{0.35, 0.65}, {outer, inner}};
    case 3:
      return {{0.22, 0.38, 0.40}, {outer, middle, inner}};
    case 5:
      return {{0.12, 0.18, 0.22, 0.24, 0.24}, {outer, outer, middle, inner, inner}};
    default:
      throw InputError("soft tissue: layers must be 1, 2, 3 or 5, not " + std::to_string(count));
  }
}

LayerStack split_layers(const LayerStack& layers, double depth_mm, double edge_mm, int most) {
  std::vector<int> pieces;
  const auto divided = [&](double longest_mm) {
    pieces.clear();
    for (const double fraction : layers.fraction)
      pieces.push_back(
          std::max(1, static_cast<int>(std::ceil(fraction * depth_mm / longest_mm - 1e-9))));
    return std::accumulate(pieces.begin(), pieces.end(), 0);
  };
  most = std::max(most, static_cast<int>(layers.fraction.size()));
  for (double longest_mm = 1.2 * edge_mm; divided(longest_mm) > most;) longest_mm *= 1.02;
  LayerStack split;
  for (std::size_t i = 0; i < layers.fraction.size(); ++i) {
    LayerMaterial material = layers.material[i];
    material.mass_kg /= pieces[i];
    split.fraction.insert(split.fraction.end(), pieces[i], layers.fraction[i] / pieces[i]);
    split.material.insert(split.material.end(), pieces[i], material);
    split.cut_from.insert(split.cut_from.end(), pieces[i], static_cast<int>(i));
  }
  return split;
}

}  // namespace condyle
