#include "sim/tissue/tissue_layers.h"

#include <algorithm>

#include "sim/tissue/tissue_defaults.h"

namespace condyle {

LayerStack layers_of(const TissuePlan& plan) {
  if (plan.layers.empty()) return default_layers(plan.layer_count.value_or(3));
  // Default materials by depth: skin outside, a softer middle, a stiffer layer next to the bone.
  const LayerStack standard = default_layers(3);
  LayerStack stack;
  const std::size_t count = plan.layers.size();
  for (std::size_t i = 0; i < count; ++i) {
    LayerMaterial material = standard.material[count == 1       ? 2
                                               : i == 0         ? 0
                                               : i + 1 == count ? 2
                                                                : 1];
    const TissueLayer& layer = plan.layers[i];
    material.modulus_MPa = layer.modulus_MPa.value_or(material.modulus_MPa);
    material.poisson = layer.poisson.value_or(material.poisson);
    material.mass_kg = layer.mass_kg.value_or(0);
    stack.fraction.push_back(layer.fraction);
    stack.material.push_back(material);
  }
  return stack;
}

double firmness_over_default(const LayerStack& layers) {
  double softest = layers.material.front().modulus_MPa;
  for (const auto& material : layers.material) softest = std::min(softest, material.modulus_MPa);
  return std::max(1.0, softest / tissue_defaults::supported_modulus_MPa);
}

SpringPrismMesh make_elements(const TissuePlan& plan, const LayerStack& layers,
                              const std::vector<Eigen::Vector3i>& triangles, const Nodes& rest) {
  constexpr double kg_per_mm3 = 1e-6;
  const int sheets = static_cast<int>(layers.fraction.size()) + 1;
  SpringPrismMesh elements =
      layered_mesh(triangles, sheets, rest, layers.material, ShearSprings::over_layers);
  if (plan.down) {
    auto material = layers.material;
    for (std::size_t layer = 0; layer < material.size(); ++layer) {
      const std::size_t whole = layers.cut_from.empty() ? layer : layers.cut_from[layer];
      if (whole < plan.layers.size() && plan.layers[whole].mass_kg) continue;
      for (std::size_t t = 0; t < triangles.size(); ++t)
        material[layer].mass_kg += kg_per_mm3 * elements.rest_volume[t * material.size() + layer];
    }
    elements = layered_mesh(triangles, sheets, rest, material, ShearSprings::over_layers);
  }
  elements.lambda = plan.lambda.value_or(elements.lambda);
  if (plan.turgor) set_turgor(elements, *plan.turgor);
  return elements;
}

}  // namespace condyle
