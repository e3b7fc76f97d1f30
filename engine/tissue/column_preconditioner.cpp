#include "engine/tissue/column_preconditioner.h"

#include <Eigen/Geometry>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Adds to the diagonal blocks of the columns.
struct Blocks {
  int nodes_per_column, size;
  std::vector<double>& entries;

  void add(int a, int b, const Matrix3d& m) {
    const int column = a / nodes_per_column;
    if (column != b / nodes_per_column) return;
    double* block = entries.data() + static_cast<std::size_t>(column) * size * size;
    const int row = 3 * (a % nodes_per_column), col = 3 * (b % nodes_per_column);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) block[(row + i) * size + col + j] += m(i, j);
  }
};

}  // namespace

ColumnPreconditioner::ColumnPreconditioner(const SpringPrismNet& net, const NetLoads& loads,
                                           int nodes_per_column, const Nodes& x)
    : size_(3 * nodes_per_column), columns_(net.node_count / nodes_per_column) {
  factors_.assign(static_cast<std::size_t>(columns_) * size_ * size_, 0.0);
  Blocks blocks{nodes_per_column, size_, factors_};
  const double lambda = net.lambda;
  for (std::size_t s = 0; s < net.spring_a.size(); ++s) {
    const int a = net.spring_a[s], b = net.spring_b[s];
    const Vector3d d = x[b] - x[a];
    const double length2 = d.squaredNorm();
    const double tension = std::max(0.0, 1 - net.rest_length[s] / std::sqrt(length2));
    const double k = 2 * lambda * net.stiffness[s];
    Matrix3d m = (k * (1 - tension) / length2) * (d * d.transpose());
    m.diagonal().array() += k * tension;
    blocks.add(a, a, m);
    blocks.add(b, b, m);
    blocks.add(a, b, -m);
    blocks.add(b, a, -m);
  }
  for (std::size_t i = 0; i < net.anchor_node.size(); ++i)
    blocks.add(net.anchor_node[i], net.anchor_node[i],
               Matrix3d::Identity() * (2 * lambda * net.anchor_stiffness[i]));
  for (std::size_t i = 0; i < net.slide_node.size(); ++i) {
    const Vector3d& n = loads.slide_normal[i];
    const int node = net.slide_node[i];
    if (n.dot(x[node]) < loads.slide_offset[i])
      blocks.add(node, node, n * n.transpose() * (2 * lambda * net.slide_stiffness[i]));
  }
  for (std::size_t p = 0; p < net.prisms.size(); ++p) {
    std::array<Vector3d, 6> slope;
    const double j = prism_volume_gradient(x, net.prisms[p], slope) / net.rest_volume[p];
    const double weight = (1 - lambda) * net.volume_weight[p] *
                          volume_stiffness(j, net.barrier_share, net.barrier_weight);
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b)
        blocks.add(net.prisms[p][a], net.prisms[p][b], weight * slope[a] * slope[b].transpose());
  }

  const int n = size_;
  for (int column = 0; column < columns_; ++column) {
    double* m = factors_.data() + static_cast<std::size_t>(column) * n * n;
    double largest = 1e-12;
    for (int i = 0; i < n; ++i) largest = std::max(largest, m[i * n + i]);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) {
        double sum = m[i * n + j];
        for (int k = 0; k < j; ++k) sum -= m[i * n + k] * m[j * n + k];
        // A node that nothing holds in some direction must not get an endless step.
        m[i * n + j] = i == j ? 1 / std::sqrt(std::max(sum, 1e-6 * largest)) : sum * m[j * n + j];
      }
    }
  }
}

void ColumnPreconditioner::apply(const Nodes& g, Nodes& z) const {
  z.resize(g.size());
  const int n = size_;
  for (int column = 0; column < columns_; ++column) {
    const double* m = factors_.data() + static_cast<std::size_t>(column) * n * n;
    const double* in = g.data()->data() + static_cast<std::size_t>(column) * n;
    double* out = z.data()->data() + static_cast<std::size_t>(column) * n;
    for (int i = 0; i < n; ++i) {
      double sum = in[i];
      for (int k = 0; k < i; ++k) sum -= m[i * n + k] * out[k];
      out[i] = sum * m[i * n + i];
    }
    for (int i = n - 1; i >= 0; --i) {  // column by column, so that the factor is read in rows
      out[i] *= m[i * n + i];
      for (int k = 0; k < i; ++k) out[k] -= m[i * n + k] * out[i];
    }
  }
}

}  // namespace condyle
