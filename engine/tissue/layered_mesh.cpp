#include "engine/tissue/layered_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "engine/core/error.h"
#include "engine/tissue/shear_springs.h"
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

namespace {

/// Builds a layered mesh: prisms first, whose volumes and weights the springs and masses share out.
class LayeredMeshBuilder {
 public:
  LayeredMeshBuilder(const std::vector<Eigen::Vector3i>& triangles, int sheets, const Nodes& nodes,
                     const std::vector<LayerMaterial>& layers, double compression_ratio,
                     ShearSprings shear_springs)
      : sheets_(sheets),
        last_(sheets - 1),
        columns_(static_cast<int>(nodes.size()) / sheets),
        nodes_(nodes),
        layers_(layers),
        edges_(edges_of(triangles)),
        windows_(shear_springs == ShearSprings::none ? std::vector<LayerWindow>()
                                                     : layer_windows(last_, flatness())),
        fraction_(of_layer(columns_, 0), 0.0),
        across_(fraction_),
        along_(of_sheet(edges_.size(), 0), 0.0),
        diagonal_(of_layer(edges_.size(), 0), 0.0),
        windowed_(edges_.size() * windows_.size(), 0.0) {
    mesh_.node_count = static_cast<int>(nodes.size());
    mesh_.compression_ratio = compression_ratio;
    std::vector<StackedPrism> stack(last_);
    for (const auto& t : triangles) {
      for (int layer = 0; layer < last_; ++layer) stack[layer] = make_prism(t, layer);
      const std::vector<double> windows = take_shear_weights(stack, windows_);
      for (int layer = 0; layer < last_; ++layer) share_out(t, layer, stack[layer]);
      for (std::size_t w = 0; w < windows.size(); ++w)
        for (int k = 0; k < 3; ++k)
          windowed_[edge_at(t[k], t[(k + 1) % 3]) * windows_.size() + w] += windows[w];
    }
    add_springs();
    add_masses();
  }

  SpringPrismMesh take() { return std::move(mesh_); }

 private:
  std::size_t of_layer(std::size_t i, int layer) const { return i * last_ + layer; }
  std::size_t of_sheet(std::size_t i, int sheet) const { return i * sheets_ + sheet; }
  std::ptrdiff_t edge_at(int a, int b) const {
    const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
    return std::lower_bound(edges_.begin(), edges_.end(), edge) - edges_.begin();
  }

  /// Mean height of a layer over the mean length of an edge of the outermost sheet.
  double flatness() const {
    double height = 0, length = 0;
    for (int c = 0; c < columns_; ++c)
      height += (nodes_[node_of(c, last_, sheets_)] - nodes_[node_of(c, 0, sheets_)]).norm();
    for (const auto& [a, b] : edges_)
      length += (nodes_[node_of(b, 0, sheets_)] - nodes_[node_of(a, 0, sheets_)]).norm();
    return height / (columns_ * last_) / (length / static_cast<double>(edges_.size()));
  }

  /// A prism of a triangle's stack, which becomes one of the mesh's.
  StackedPrism make_prism(const Eigen::Vector3i& t, int layer) {
    StackedPrism made;
    std::array<int, 6> prism;
    for (int k = 0; k < 3; ++k) {
      prism[k] = node_of(t[k], layer, sheets_);
      prism[k + 3] = node_of(t[k], layer + 1, sheets_);
    }
    for (int k = 0; k < 6; ++k) made.corners[k] = nodes_[prism[k]];
    made.volume = prism_volume(nodes_, prism);
    const double shear = layers_[layer].modulus_MPa / (2 * (1 + layers_[layer].poisson));
    made.shear = 2 * shear / (1 + mesh_.compression_ratio);
    made.weights = isotropic_weights(made.corners, made.volume);
    mesh_.prisms.push_back(prism);
    mesh_.rest_volume.push_back(made.volume);
    mesh_.volume_weight.push_back(0.5 * bulk_modulus_of_prisms(layers_[layer]) / made.volume);
    return made;
  }

  void share_out(const Eigen::Vector3i& t, int layer, const StackedPrism& prism) {
    for (int k = 0; k < 3; ++k) {
      fraction_[of_layer(t[k], layer)] += prism.volume / 3;
      across_[of_layer(t[k], layer)] += prism.shear * prism.weights.across;
      const auto edge = edge_at(t[k], t[(k + 1) % 3]);
      along_[of_sheet(edge, layer)] += prism.shear * prism.weights.along[k];
      along_[of_sheet(edge, layer + 1)] += prism.shear * prism.weights.along[k];
      diagonal_[of_layer(edge, layer)] += prism.shear * prism.weights.diagonal[k];
    }
  }

  void add_spring(int a, int b, int layer, int sheet, double resists) {
    const double length = (nodes_[b] - nodes_[a]).norm();
    mesh_.spring_a.push_back(a);
    mesh_.spring_b.push_back(b);
    mesh_.rest_length.push_back(length);
    mesh_.stiffness.push_back(0.5 * resists / (length * length));
    mesh_.spring_layer.push_back(layer);
    mesh_.spring_sheet.push_back(sheet);
  }

  void add_springs() {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const auto [a, b] = edges_[e];
      for (int sheet = 0; sheet < sheets_; ++sheet)
        add_spring(node_of(a, sheet, sheets_), node_of(b, sheet, sheets_),
                   std::min(sheet, last_ - 1), sheet, along_[of_sheet(e, sheet)]);
      // One direction, then the other: consecutive springs form a batch (ElementBatches).
      for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}})
        for (int layer = 0; layer < last_; ++layer)
          add_spring(node_of(from, layer, sheets_), node_of(to, layer + 1, sheets_), layer, -1,
                     diagonal_[of_layer(e, layer)]);
      for (std::size_t w = 0; w < windows_.size(); ++w)
        if (const double weight = windowed_[e * windows_.size() + w]; weight > 0) {
          const int first = windows_[w].first, last = first + windows_[w].count;
          add_spring(node_of(a, last, sheets_), node_of(b, first, sheets_), first, -1, weight);
          add_spring(node_of(a, first, sheets_), node_of(b, last, sheets_), first, -1, weight);
        }
    }
    for (int column = 0; column < columns_; ++column)
      for (int layer = 0; layer < last_; ++layer)
        add_spring(node_of(column, layer, sheets_), node_of(column, layer + 1, sheets_), layer, -1,
                   across_[of_layer(column, layer)]);
  }

  /// Those of a layer at a column, half at the node above and half at the node below.
  void add_masses() {
    mesh_.node_mass_kg.assign(nodes_.size(), 0.0);
    for (int layer = 0; layer < last_; ++layer) {
      double volume = 0;
      for (int column = 0; column < columns_; ++column)
        volume += fraction_[of_layer(column, layer)];
      for (int column = 0; column < columns_; ++column)
        for (int sheet : {layer, layer + 1})
          mesh_.node_mass_kg[node_of(column, sheet, sheets_)] +=
              0.5 * layers_[layer].mass_kg * fraction_[of_layer(column, layer)] / volume;
    }
  }

  const int sheets_, last_, columns_;
  const Nodes& nodes_;
  const std::vector<LayerMaterial>& layers_;
  const std::vector<std::array<int, 2>> edges_;
  const std::vector<LayerWindow> windows_;
  // Volume of a layer at each column.
  std::vector<double> fraction_;
  // Weight of each spring in N mm, shear modulus times the volume that it represents: across a
  // layer at a column, along a sheet at an edge, and of both diagonals of a layer or of a window of
  // layers at an edge.
  std::vector<double> across_, along_, diagonal_, windowed_;
  SpringPrismMesh mesh_;
};

}  // namespace

SpringPrismMesh layered_mesh(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                             const Nodes& nodes, const std::vector<LayerMaterial>& layers,
                             ShearSprings shear_springs, double compression_ratio) {
  assert(sheets >= 2 && layers.size() + 1 == static_cast<std::size_t>(sheets));
  assert(nodes.size() % static_cast<std::size_t>(sheets) == 0);
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
  return LayeredMeshBuilder(triangles, sheets, nodes, layers, compression_ratio, shear_springs)
      .take();
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
