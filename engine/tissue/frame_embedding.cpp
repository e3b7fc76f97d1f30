#include "engine/tissue/frame_embedding.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>

#include "engine/tissue/layered_mesh.h"

namespace condyle {

using Eigen::Matrix3d;
using Eigen::Vector3d;

HandleSet make_handles(const std::vector<Eigen::Vector3i>& triangles, int sheets,
                       const Nodes& rest) {
  HandleSet set;
  const int columns = static_cast<int>(rest.size()) / sheets;
  set.ring.resize(columns);
  for (const auto& [a, b] : edges_of(triangles)) {
    set.ring[a].push_back(b);
    set.ring[b].push_back(a);
  }
  set.first_neighbour.push_back(0);
  for (int column = 0; column < columns; ++column) {
    const int node = node_of(column, 0, sheets);
    set.node.push_back(node);
    for (int n : set.ring[column])
      for (int sheet : {0, std::min(1, sheets - 1)})
        set.neighbour.push_back(node_of(n, sheet, sheets));
    for (int sheet = 1; sheet < sheets; ++sheet)
      set.neighbour.push_back(node_of(column, sheet, sheets));
    Matrix3d spread = Matrix3d::Zero();
    for (std::size_t k = set.first_neighbour.back(); k < set.neighbour.size(); ++k) {
      const Vector3d d = rest[set.neighbour[k]] - rest[node];
      spread += d * d.transpose() / d.squaredNorm();
    }
    set.inverse_spread.push_back(spread.inverse());
    set.first_neighbour.push_back(static_cast<int>(set.neighbour.size()));
  }
  return set;
}

namespace {

/// The deformation gradient (minus 1) with limited stretches: points off the mesh are extrapolated,
/// and a strongly stretched node would displace them far.
Matrix3d limited(const Matrix3d& stretched) {
  constexpr double least = 0.6, most = 1.4;
  const Matrix3d A = stretched + Matrix3d::Identity();
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(A.transpose() * A);
  const Vector3d stretch = solver.eigenvalues().cwiseMax(1e-12).cwiseSqrt();
  if (stretch.minCoeff() >= least && stretch.maxCoeff() <= most) return stretched;
  const Vector3d scale = stretch.cwiseMax(least).cwiseMin(most).cwiseQuotient(stretch);
  const Matrix3d& V = solver.eigenvectors();
  return A * V * scale.asDiagonal() * V.transpose() - Matrix3d::Identity();
}

}  // namespace

HandleMotion handle_motion(const HandleSet& handles, const Nodes& rest, const Nodes& now) {
  assert(rest.size() == now.size());
  const std::size_t count = handles.node.size();
  HandleMotion motion;
  motion.moved.resize(count);
  std::vector<Matrix3d> own(count);
  for (std::size_t h = 0; h < count; ++h) {
    const int node = handles.node[h];
    motion.moved[h] = now[node] - rest[node];
    Matrix3d sum = Matrix3d::Zero();
    for (int k = handles.first_neighbour[h]; k < handles.first_neighbour[h + 1]; ++k) {
      const int n = handles.neighbour[k];
      const Vector3d d = rest[n] - rest[node];
      sum += ((now[n] - rest[n]) - motion.moved[h]) * d.transpose() / d.squaredNorm();
    }
    own[h] = sum * handles.inverse_spread[h];
  }
  // One round of averaging over the ring removes the noise of single nodes.
  motion.stretched.resize(count);
  for (std::size_t h = 0; h < count; ++h) {
    Matrix3d sum = 2 * own[h];
    for (int n : handles.ring[h]) sum += own[n];
    motion.stretched[h] = limited(sum / (2.0 + static_cast<double>(handles.ring[h].size())));
  }
  return motion;
}

CarriedPoint carry(const std::vector<int>& candidates, const BodyDistance& distance,
                   double reach_fraction) {
  assert(!candidates.empty() && reach_fraction > 0);
  std::vector<std::pair<double, int>> order;
  order.reserve(candidates.size());
  for (int h : candidates) order.emplace_back(distance(h), h);
  const std::size_t kept = std::min<std::size_t>(CarriedPoint::capacity, order.size());
  const std::size_t reach = std::min(kept, order.size() - 1);  // the first one omitted, if any
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(reach + 1),
                    order.end());
  const double radius = reach_fraction * (order.size() > kept ? order[reach].first
                                                              : order[reach].first * 1.0001 + 1e-9);
  CarriedPoint point;
  double sum = 0;
  std::array<double, CarriedPoint::capacity> weight{};
  for (std::size_t k = 0; k < kept; ++k) {
    const double u = order[k].first / radius;
    weight[k] = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
    point.handle[k] = order[k].second;
    sum += weight[k];
  }
  for (std::size_t k = 0; k < kept; ++k)
    point.weight[k] = static_cast<float>(sum > 0 ? weight[k] / sum : (k == 0 ? 1.0 : 0.0));
  return point;
}

}  // namespace condyle
