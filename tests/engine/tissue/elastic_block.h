#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/math/pose.h"
#include "engine/tissue/layered_mesh.h"
#include "engine/tissue/refactorization.h"

/// Boxes of layered tissue and their response to loads.
namespace condyle {

/// A mesh of triangles with edges of `edge` mm: `along` of them along x, `rows` rows along y; and
/// `layers` along z, of `height` mm each.
struct BoxSize {
  int along, rows, layers;
  double edge, height;
  Eigen::Vector3d mm() const {
    return {along * edge, rows * edge * std::sqrt(0.75), layers * height};
  }
};

struct ElasticBlock {
  BoxSize size;
  Pose pose;  // of the box in the world: nothing may depend on it
  LayerMaterial material;
  std::vector<Eigen::Vector2d> place;  // of the columns, as fractions of the box
  std::vector<Eigen::Vector3i> triangles;
  Nodes rest;
  SpringPrismMesh mesh;

  /// f(node, its coordinates as fractions of the box along x, y and z)
  template <class F>
  void each_node(F&& f) const {
    for (std::size_t c = 0; c < place.size(); ++c)
      for (int sheet = 0; sheet <= size.layers; ++sheet)
        f(node_of(static_cast<int>(c), sheet, size.layers + 1),
          Eigen::Vector3d(place[c].x(), place[c].y(),
                          1 - static_cast<double>(sheet) / size.layers));
  }
};

inline Pose tilted_pose() {
  Pose pose;
  pose.R = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized());
  pose.t = {12, -30, 5};
  return pose;
}

inline ElasticBlock make_block(const BoxSize& size, const LayerMaterial& material,
                               double compression_ratio) {
  ElasticBlock block{size, tilted_pose(), material, {}, {}, {}, {}};
  // Odd rows are shifted by half an edge, with a node more to reach both ends.
  std::vector<int> row_start;
  for (int j = 0; j <= size.rows; ++j) {
    row_start.push_back(static_cast<int>(block.place.size()));
    const int last = size.along + j % 2;
    for (int i = 0; i <= last; ++i) {
      const double x = j % 2 ? std::clamp(i - 0.5, 0.0, 1.0 * size.along) : i;
      block.place.emplace_back(x / size.along, static_cast<double>(j) / size.rows);
    }
  }
  for (int j = 0; j < size.rows; ++j) {
    // Seen with y upward: the even row's node i lies between the odd row's i and i + 1.
    const bool odd_above = j % 2 == 0;
    const int even = row_start[odd_above ? j : j + 1], odd = row_start[odd_above ? j + 1 : j];
    const auto add = [&](int a, int b, int c) {
      block.triangles.emplace_back(a, odd_above ? b : c, odd_above ? c : b);
    };
    for (int i = 0; i <= size.along; ++i) {
      add(even + i, odd + i + 1, odd + i);
      if (i < size.along) add(even + i, even + i + 1, odd + i + 1);
    }
  }
  block.rest.resize(block.place.size() * (size.layers + 1));
  block.each_node([&](int node, const Eigen::Vector3d& at) {
    block.rest[node] = block.pose * Eigen::Vector3d(at.cwiseProduct(size.mm()));
  });
  block.mesh = layered_mesh(block.triangles, size.layers + 1, block.rest,
                            std::vector<LayerMaterial>(size.layers, material), ShearSprings::none,
                            compression_ratio);
  return block;
}

/// Fixes a node, or pulls it to its target.
inline void hold(ElasticBlock& block, MeshLoads& loads, int node, const Eigen::Vector3d& target,
                 double stiffness) {
  block.mesh.anchor_node.push_back(node);
  block.mesh.anchor_stiffness.push_back(stiffness);
  loads.anchor_target.push_back(target);
}

struct Settled {
  Nodes nodes;    // in the box's own coordinate frame
  double energy;  // mJ, of an elastic body: without the weight lambda
  bool converged;
};

inline Settled settle(const ElasticBlock& block, const MeshLoads& loads) {
  Nodes x = block.rest;
  const HessianFactor factor(block.mesh, loads, 1, block.rest);
  SpringPrismEnergy energy(block.mesh, loads, 1);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-6;
  const auto result = minimize_with_refactorization(block.mesh, loads, energy, factor, settings, x);
  const Pose back = block.pose.inverse();
  for (auto& p : x) p = back * p;
  return {x, result.energy / block.mesh.lambda, result.converged()};
}

}  // namespace condyle
