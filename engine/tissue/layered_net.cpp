#include "engine/tissue/layered_net.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/error.h"

namespace condyle {
namespace {

/// Not a number is out of any range.
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

SpringPrismNet layered_net(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                           const Nodes& nodes, const std::vector<LayerMaterial>& layers) {
  for (const auto& layer : layers) {
    require(layer.modulus_MPa > 0 && layer.modulus_MPa < 1e6,
            "a layer's modulus must be above 0 and below 1e6 MPa", layer.modulus_MPa);
    require(layer.bulk_MPa > 0 && layer.bulk_MPa < 1e6,
            "a layer's resistance to volume change must be above 0 and below 1e6 MPa",
            layer.bulk_MPa);
    require(layer.mass_kg >= 0 && layer.mass_kg < 1e3, "a layer's mass must be 0 to 1000 kg",
            layer.mass_kg);
  }
  SpringPrismNet net;
  net.node_count = static_cast<int>(nodes.size());
  const int columns = net.node_count / sheets;

  // Volume and stiffness that each node of each layer carries: a third of every prism at its
  // column.
  std::vector<double> share(static_cast<std::size_t>(columns) * (sheets - 1), 0.0);
  for (int layer = 0; layer + 1 < sheets; ++layer)
    for (const auto& t : triangles) {
      std::array<int, 6> prism;
      for (int k = 0; k < 3; ++k) {
        prism[k] = node_of(t[k], layer, sheets);
        prism[k + 3] = node_of(t[k], layer + 1, sheets);
      }
      const double volume = prism_volume(nodes, prism);
      net.prisms.push_back(prism);
      net.rest_volume.push_back(volume);
      net.volume_weight.push_back(0.5 * layers[layer].bulk_MPa / volume);
      for (int k = 0; k < 3; ++k) share[t[k] * (sheets - 1) + layer] += volume / 3;
    }

  // A spring of length l that stands for volume v of modulus E stores E/2 (dl/l)^2 v.
  const auto add_spring = [&](int a, int b, int layer, int sheet, double modulus_times_volume) {
    const double length = (nodes[b] - nodes[a]).norm();
    net.spring_a.push_back(a);
    net.spring_b.push_back(b);
    net.rest_length.push_back(length);
    net.stiffness.push_back(0.5 * modulus_times_volume / (length * length));
    net.spring_layer.push_back(layer);
    net.spring_sheet.push_back(sheet);
  };
  const auto carried = [&](int column, int layer) {
    return share[column * (sheets - 1) + layer] * layers[layer].modulus_MPa;
  };
  const int last = sheets - 1;
  std::vector<int> valence(columns, 0);
  const auto edges = edges_of(triangles);
  for (const auto& [a, b] : edges) {
    ++valence[a];
    ++valence[b];
  }
  for (const auto& [a, b] : edges) {
    // What an edge stands for: its part of both columns, per layer.
    const auto edge_share = [&](int layer) {
      return carried(a, layer) / valence[a] + carried(b, layer) / valence[b];
    };
    for (int sheet = 0; sheet < sheets; ++sheet) {
      const double above = sheet > 0 ? edge_share(sheet - 1) : 0;
      const double below = sheet < last ? edge_share(sheet) : 0;
      add_spring(node_of(a, sheet, sheets), node_of(b, sheet, sheets), std::min(sheet, last - 1),
                 sheet, 0.5 * (above + below));
    }
    for (int layer = 0; layer < last; ++layer) {
      const double diagonal = 0.5 * edge_share(layer);
      add_spring(node_of(a, layer, sheets), node_of(b, layer + 1, sheets), layer, -1, diagonal);
      add_spring(node_of(b, layer, sheets), node_of(a, layer + 1, sheets), layer, -1, diagonal);
    }
  }
  for (int column = 0; column < columns; ++column)
    for (int layer = 0; layer < last; ++layer)
      add_spring(node_of(column, layer, sheets), node_of(column, layer + 1, sheets), layer, -1,
                 carried(column, layer));

  // Masses: what a layer carries at a column, half to the node above and half to that below.
  net.node_mass_kg.assign(nodes.size(), 0.0);
  for (int layer = 0; layer < last; ++layer) {
    double volume = 0;
    for (int column = 0; column < columns; ++column) volume += share[column * last + layer];
    for (int column = 0; column < columns; ++column)
      for (int sheet : {layer, layer + 1})
        net.node_mass_kg[node_of(column, sheet, sheets)] +=
            0.5 * layers[layer].mass_kg * share[column * last + layer] / volume;
  }
  return net;
}

void use_paper_form(SpringPrismNet& net, const PaperForm& form) {
  require(form.lambda > 0 && form.lambda < 1, "lambda must be above 0 and below 1", form.lambda);
  for (double k : form.layer_stiffness)
    require(k > 0 && std::isfinite(k), "a spring constant must be above 0", k);
  net.lambda = form.lambda;
  net.compression_share = 1;
  net.barrier_weight = 0;
  for (std::size_t s = 0; s < net.stiffness.size(); ++s)
    net.stiffness[s] = form.layer_stiffness.at(net.spring_layer[s]);
  net.volume_weight.assign(net.prisms.size(), 1.0);
}

void set_turgor(SpringPrismNet& net, double c_turgor) {
  require(c_turgor > 0 && c_turgor <= 1, "skin turgor must be above 0 and at most 1", c_turgor);
  for (std::size_t s = 0; s < net.spring_sheet.size(); ++s)
    if (net.spring_sheet[s] == 0) net.rest_length[s] *= c_turgor;
}

}  // namespace condyle
