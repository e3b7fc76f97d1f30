#include "engine/tissue/layered_mesh.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/error.h"
#include "engine/tissue/spring_map.h"

namespace condyle {
namespace {

/// NaN is outside every range.
void require(bool in_range, const char* what, double value) {
  if (!in_range)
    throw InputError("soft tissue: " + std::string(what) + ", not " + std::to_string(value));
}

}  // namespace

std::vector<std::array<int, 2>> edges_of(const std::vector<Eigen::Vector3i>& triangles) {
  std::vector<std::array<int, 2>> edges;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

double bulk_modulus_of_prisms(const LayerMaterial& layer) {
  const double shear = layer.modulus_MPa / (2 * (1 + layer.poisson));
  return shear * (4 * layer.poisson - 1) / (1 - 2 * layer.poisson);
}

SpringPrismMesh layered_mesh(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                             const Nodes& nodes, const std::vector<LayerMaterial>& layers,
                             double compression_ratio) {
  for (const auto& layer : layers) {
    require(layer.modulus_MPa > 0 && layer.modulus_MPa < 1e6,
            "a layer's modulus must be above 0 and below 1e6 MPa", layer.modulus_MPa);
    require(layer.poisson > 0.25 && layer.poisson < 0.5,
            "a layer's Poisson's ratio must be above 0.25 and below 0.5", layer.poisson);
    require(layer.mass_kg >= 0 && layer.mass_kg < 1e3, "a layer's mass must be 0 to 1000 kg",
            layer.mass_kg);
  }
  require(compression_ratio > 0 && compression_ratio <= 1,
          "the stiffness of shortened springs must be above 0 and at most 1 of the stretched ones'",
          compression_ratio);
  SpringPrismMesh mesh;
  mesh.node_count = static_cast<int>(nodes.size());
  mesh.compression_ratio = compression_ratio;
  const int columns = mesh.node_count / sheets, last = sheets - 1;
  const auto edges = edges_of(triangles);
  const auto edge_at = [&](int a, int b) {
    const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
    return std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin();
  };

  // Prisms, the volume of a layer at each column, and the weight of each spring in N mm: shear
  // modulus times the volume it represents.
  const auto of_layer = [&](std::size_t i, int layer) { return i * last + layer; };
  const auto of_sheet = [&](std::size_t i, int sheet) { return i * sheets + sheet; };
  std::vector<double> fraction(of_layer(columns, 0), 0.0), across(fraction);
  std::vector<double> along(of_sheet(edges.size(), 0), 0.0);
  std::vector<double> diagonal(of_layer(edges.size(), 0), 0.0);
  for (const auto& t : triangles)
    for (int layer = 0; layer < last; ++layer) {
      const double shear = layers[layer].modulus_MPa / (2 * (1 + layers[layer].poisson));
      const double mean_shear = 2 * shear / (1 + compression_ratio);
      std::array<int, 6> prism;
      std::array<Eigen::Vector3d, 6> corners;
      for (int k = 0; k < 3; ++k) {
        prism[k] = node_of(t[k], layer, sheets);
        prism[k + 3] = node_of(t[k], layer + 1, sheets);
      }
      for (int k = 0; k < 6; ++k) corners[k] = nodes[prism[k]];
      const double volume = prism_volume(nodes, prism);
      mesh.prisms.push_back(prism);
      mesh.rest_volume.push_back(volume);
      mesh.volume_weight.push_back(0.5 * bulk_modulus_of_prisms(layers[layer]) / volume);
      const PrismWeights weights = isotropic_weights(corners, volume);
      for (int k = 0; k < 3; ++k) {
        fraction[of_layer(t[k], layer)] += volume / 3;
        across[of_layer(t[k], layer)] += mean_shear * weights.across;
        const auto edge = edge_at(t[k], t[(k + 1) % 3]);
        along[of_sheet(edge, layer)] += mean_shear * weights.along[k];
        along[of_sheet(edge, layer + 1)] += mean_shear * weights.along[k];
        diagonal[of_layer(edge, layer)] += mean_shear * weights.diagonal[k];
      }
    }

  const auto add_spring = [&](int a, int b, int layer, int sheet, double resists) {
    const double length = (nodes[b] - nodes[a]).norm();
    mesh.spring_a.push_back(a);
    mesh.spring_b.push_back(b);
    mesh.rest_length.push_back(length);
    mesh.stiffness.push_back(0.5 * resists / (length * length));
    mesh.spring_layer.push_back(layer);
    mesh.spring_sheet.push_back(sheet);
  };
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges[e];
    for (int sheet = 0; sheet < sheets; ++sheet)
      add_spring(node_of(a, sheet, sheets), node_of(b, sheet, sheets), std::min(sheet, last - 1),
                 sheet, along[of_sheet(e, sheet)]);
    // One direction, then the other: consecutive springs form a batch (ElementBatches).
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}})
      for (int layer = 0; layer < last; ++layer)
        add_spring(node_of(from, layer, sheets), node_of(to, layer + 1, sheets), layer, -1,
                   diagonal[of_layer(e, layer)]);
  }
  for (int column = 0; column < columns; ++column)
    for (int layer = 0; layer < last; ++layer)
      add_spring(node_of(column, layer, sheets), node_of(column, layer + 1, sheets), layer, -1,
                 across[of_layer(column, layer)]);

  // Masses: those of a layer at a column, half at the node above and half at the node below.
  mesh.node_mass_kg.assign(nodes.size(), 0.0);
  for (int layer = 0; layer < last; ++layer) {
    double volume = 0;
    for (int column = 0; column < columns; ++column) volume += fraction[of_layer(column, layer)];
    for (int column = 0; column < columns; ++column)
      for (int sheet : {layer, layer + 1})
        mesh.node_mass_kg[node_of(column, sheet, sheets)] +=
            0.5 * layers[layer].mass_kg * fraction[of_layer(column, layer)] / volume;
  }
  return mesh;
}

void use_paper_form(SpringPrismMesh& mesh, const PaperForm& form) {
  require(form.lambda > 0 && form.lambda < 1, "lambda must be above 0 and below 1", form.lambda);
  for (double k : form.layer_stiffness)
    require(k > 0 && std::isfinite(k), "a spring constant must be above 0", k);
  mesh.lambda = form.lambda;
  mesh.compression_ratio = 1;
  mesh.barrier_weight = 0;
  for (std::size_t s = 0; s < mesh.stiffness.size(); ++s)
    mesh.stiffness[s] = form.layer_stiffness.at(mesh.spring_layer[s]);
  mesh.volume_weight.assign(mesh.prisms.size(), 1.0);
}

void set_turgor(SpringPrismMesh& mesh, double c_turgor) {
  require(c_turgor > 0 && c_turgor <= 1, "skin turgor must be above 0 and at most 1", c_turgor);
  for (std::size_t s = 0; s < mesh.spring_sheet.size(); ++s)
    if (mesh.spring_sheet[s] == 0) mesh.rest_length[s] *= c_turgor;
}

}  // namespace condyle
