#include "engine/tissue/hessian_factor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int corner_pairs = 15;  // of a prism

std::shared_ptr<const FrontTree> make_tree(const SpringPrismNet& net, int nodes_per_column,
                                           const Nodes& x) {
  const int columns = net.node_count / nodes_per_column;
  std::vector<std::vector<int>> ring(columns);
  const auto couple = [&](int a, int b) {
    a /= nodes_per_column;
    b /= nodes_per_column;
    if (a == b) return;
    ring[a].push_back(b);
    ring[b].push_back(a);
  };
  for (std::size_t s = 0; s < net.spring_a.size(); ++s) couple(net.spring_a[s], net.spring_b[s]);
  for (const auto& prism : net.prisms)
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < a; ++b) couple(prism[a], prism[b]);
  for (const auto& [a, b] : net.may_touch) couple(a, b);
  for (auto& r : ring) {
    std::sort(r.begin(), r.end());
    r.erase(std::unique(r.begin(), r.end()), r.end());
  }
  std::vector<Vector3d> position;
  for (int c = 0; c < columns; ++c) position.push_back(x[c * nodes_per_column]);
  return std::make_shared<const FrontTree>(ring, elimination_order(ring, position),
                                           3 * nodes_per_column);
}

/// Lower half of a symmetric matrix.
struct Symmetric {
  double xx = 0, yx = 0, zx = 0, yy = 0, zy = 0, zz = 0;
  /// += factor d d^T + diagonal I
  void add(double factor, const Vector3d& d, double diagonal) {
    const Vector3d u = factor * d;
    xx += u.x() * d.x() + diagonal;
    yx += u.y() * d.x();
    zx += u.z() * d.x();
    yy += u.y() * d.y() + diagonal;
    zy += u.z() * d.y();
    zz += u.z() * d.z() + diagonal;
  }
};

/// Three numbers of a column of the matrix; the fourth is 0, and what stands below them stays.
typedef float Column __attribute__((vector_size(4 * sizeof(float))));
inline Column column_of(const Vector3d& v) {
  return Column{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}
inline void add_column(float* to, const Column& column) {
  Column sum;
  std::memcpy(&sum, to, sizeof sum);
  sum += column;
  std::memcpy(to, &sum, sizeof sum);
}

}  // namespace

/// A 3 x 3 part of the matrix: its first float, that of its row node and column node, which is the
/// one eliminated first.
struct HessianFactor::Pattern {
  struct Spot {  // eight bytes: there are many, and all are read
    static constexpr std::uint32_t nowhere = ~0u;
    std::uint32_t at = nowhere;  // not stored
    std::uint32_t stride : 28;
    std::uint32_t part : 3;
    std::uint32_t swapped : 1;  // the row is the second of the two nodes
    bool stored() const { return at != nowhere; }
  };

  std::shared_ptr<const FrontTree> tree;
  int nodes_per_column = 1;
  std::vector<Spot> diagonal;                           // of each node
  std::vector<Spot> spring;                             // of its two nodes
  std::vector<Spot> prism;                              // corner_pairs of each
  std::vector<std::vector<int>> springs_of, prisms_of;  // part -> those with an entry in it

  Pattern(const SpringPrismNet& net, int nodes, const Nodes& x)
      : tree(make_tree(net, nodes, x)), nodes_per_column(nodes), springs_of(3), prisms_of(3) {
    for (int n = 0; n < net.node_count; ++n) diagonal.push_back(spot(n, n));
    for (std::size_t s = 0; s < net.spring_a.size(); ++s) {
      spring.push_back(spot(net.spring_a[s], net.spring_b[s]));
      list(springs_of, static_cast<int>(s), std::array{net.spring_a[s], net.spring_b[s]});
    }
    for (std::size_t p = 0; p < net.prisms.size(); ++p) {
      for (int a = 1; a < 6; ++a)
        for (int b = 0; b < a; ++b) prism.push_back(spot(net.prisms[p][a], net.prisms[p][b]));
      list(prisms_of, static_cast<int>(p), net.prisms[p]);
    }
  }

  /// Whether b is the row of the entry of a and b, a its column.
  bool is_below(int b, int a) const {
    const int pa = tree->place[a / nodes_per_column], pb = tree->place[b / nodes_per_column];
    return pb != pa ? pb > pa : b > a;
  }
  Spot spot(int a, int b) const {
    const int row = is_below(a, b) ? a : b, column = row == a ? b : a;
    const int at_row = tree->place[row / nodes_per_column];
    const int at_column = tree->place[column / nodes_per_column];
    const std::ptrdiff_t block = tree->find(at_row, at_column);
    const int stride = tree->height(tree->fronts[tree->front_of[at_column]]);
    Spot spot;
    spot.stride = static_cast<std::uint32_t>(stride);
    if (block >= 0)
      spot.at = static_cast<std::uint32_t>(
          block + static_cast<std::ptrdiff_t>(3 * (column % nodes_per_column)) * stride +
          3 * (row % nodes_per_column));
    spot.part = static_cast<std::uint32_t>(part_of(column));
    spot.swapped = row == b && a != b;
    return spot;
  }
  int part_of(int node) const {
    const int at = tree->place[node / nodes_per_column];
    return at < tree->order.part[1] ? 0 : at < tree->order.part[2] ? 1 : 2;
  }

 private:
  template <std::size_t n>
  void list(std::vector<std::vector<int>>& of, int element, const std::array<int, n>& nodes) const {
    std::array<bool, 3> in{};
    for (int node : nodes) in[part_of(node)] = true;
    for (int part = 0; part < 3; ++part)
      if (in[part]) of[part].push_back(element);
  }
};

HessianFactor::HessianFactor(std::shared_ptr<const Pattern> pattern, BlockCholesky factor)
    : pattern_(std::move(pattern)), factor_(std::move(factor)) {}

HessianFactor::HessianFactor(const SpringPrismNet& net, const NetLoads& loads, int nodes_per_column,
                             const Nodes& x, int threads)
    : threads_(threads),
      pattern_(std::make_shared<const Pattern>(net, nodes_per_column, x)),
      factor_(pattern_->tree) {
  refactor(net, loads, x, threads);
}

int HessianFactor::refactor(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                            int threads, Curvatures curvatures) {
  const bool exact = curvatures == Curvatures::exact;
  using Spot = Pattern::Spot;
  const Pattern& pattern = *pattern_;
  const double lambda = net.lambda;
  const auto assemble = [&](int part, float* values) {
    const auto wanted = static_cast<std::uint32_t>(part);
    const auto add = [&](const Spot& spot, const Matrix3d& m) {
      if (spot.part != wanted) return;
      float* to = values + spot.at;
      for (int j = 0; j < 3; ++j) add_column(to + j * spot.stride, column_of(m.col(j)));
    };
    std::vector<Symmetric> own(net.node_count);  // each node's own entry
    for (int s : pattern.springs_of[part]) {
      const int a = net.spring_a[s], b = net.spring_b[s];
      const Vector3d d = x[b] - x[a];
      const double length2 = d.squaredNorm();
      const double strain = 1 - net.rest_length[s] / std::sqrt(length2);
      const double tension = exact ? strain : std::max(0.0, strain);
      // At rest a spring may yet go either way; the stretched ones are those that matter.
      const double k =
          2 * lambda * net.stiffness[s] * (strain < -1e-9 ? net.compression_share : 1.0);
      const double along = k * (1 - tension) / length2, across = k * tension;
      own[a].add(along, d, across);
      own[b].add(along, d, across);
      if (pattern.spring[s].part != wanted) continue;
      Matrix3d m = along * d * d.transpose();
      m.diagonal().array() += across;
      add(pattern.spring[s], -m);
    }
    for (std::size_t i = 0; i < net.anchor_node.size(); ++i)
      own[net.anchor_node[i]].add(0, Vector3d::Zero(), 2 * lambda * net.anchor_stiffness[i]);
    // Two surfaces that touch may couple columns that no spring does. Then each surface alone is
    // taken (weights of one sign), which leaves the matrix positive definite.
    for (const auto& row : loads.contacts) {
      if (row.gap(x) >= 0) continue;
      std::array<Spot, ContactRow::capacity * ContactRow::capacity> spots;
      bool whole = true;
      for (int a = 0; a < row.count; ++a)
        for (int b = 0; b <= a; ++b) {
          Spot& spot = spots[a * ContactRow::capacity + b];
          spot = pattern.spot(row.node[a], row.node[b]);
          whole = whole && spot.stored();
        }
      const Matrix3d m = row.normal * row.normal.transpose() * (2 * lambda * row.stiffness);
      for (int a = 0; a < row.count; ++a)
        for (int b = 0; b <= a; ++b) {
          const double weight = row.weight[a] * row.weight[b];
          const Spot& spot = spots[a * ContactRow::capacity + b];
          if (spot.stored() && (whole || weight > 0)) add(spot, weight * m);
        }
    }
    for (int p : pattern.prisms_of[part]) {
      const auto& prism = net.prisms[p];
      std::array<Vector3d, 6> slope;
      const double j = prism_volume_gradient(x, prism, slope) / net.rest_volume[p];
      const double weight = (1 - lambda) * net.volume_weight[p] *
                            volume_stiffness(j, net.barrier_share, net.barrier_weight);
      std::array<Vector3d, corner_pairs> bend;
      if (exact) {
        bend = prism_volume_bend(x, prism);
        const double pressure = (1 - lambda) * net.volume_weight[p] * net.rest_volume[p] *
                                volume_pressure(j, net.barrier_share, net.barrier_weight);
        for (auto& b : bend) b *= pressure;
      }
      std::array<Column, 6> slopes, weighted;
      for (int a = 0; a < 6; ++a) {
        slopes[a] = column_of(slope[a]);
        weighted[a] = static_cast<float>(weight) * slopes[a];
      }
      const Spot* pair = &pattern.prism[static_cast<std::size_t>(p) * corner_pairs];
      for (int a = 0; a < 6; ++a) {
        own[prism[a]].add(weight, slope[a], 0);
        for (int b = 0; b < a; ++b, ++pair) {
          if (pair->part != wanted) continue;
          const int row = pair->swapped ? b : a, column = pair->swapped ? a : b;
          float* to = values + pair->at;
          const Column &steep = slopes[row], &along = weighted[column];
          if (exact) {
            // The matrix whose product with v is u x v.
            const Column u = (pair->swapped ? -1.0f : 1.0f) * column_of(bend[a * (a - 1) / 2 + b]);
            add_column(to, along[0] * steep + Column{0, u[2], -u[1], 0});
            add_column(to + pair->stride, along[1] * steep + Column{-u[2], 0, u[0], 0});
            add_column(to + 2 * pair->stride, along[2] * steep + Column{u[1], -u[0], 0, 0});
          } else {
            for (int k = 0; k < 3; ++k) add_column(to + k * pair->stride, along[k] * steep);
          }
        }
      }
    }
    // A node that nothing holds in some direction must not get an endless step.
    for (int n = 0; n < net.node_count; ++n) {
      const Spot& spot = pattern.diagonal[n];
      if (spot.part != wanted) continue;
      float* to = values + spot.at;
      const std::array below{own[n].xx, own[n].yx, own[n].zx, own[n].yy, own[n].zy, own[n].zz};
      for (int j = 0, k = 0; j < 3; ++j)
        for (int i = j; i < 3; ++i) to[j * spot.stride + i] += static_cast<float>(below[k++]);
      const float most = std::max({to[0], to[spot.stride + 1], to[2 * spot.stride + 2]});
      for (int i = 0; i < 3; ++i) to[i * (spot.stride + 1)] += 1e-5f * most + 1e-12f;
    }
  };
  constexpr float least = 1e-6f;
  return factor_.factorize(assemble, least, threads);
}

HessianFactor HessianFactor::anew(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                                  int threads) const {
  HessianFactor made = another();
  made.set_threads(threads_);
  if (made.refactor(net, loads, x, threads, Curvatures::exact) > 0)
    made.refactor(net, loads, x, threads);
  return made;
}

void HessianFactor::solve(const Nodes& g, Nodes& z) const {
  const auto& at = pattern_->tree->order.at;
  const int nodes = pattern_->nodes_per_column;
  std::vector<float> b(g.size() * 3);
  std::size_t i = 0;
  for (int column : at)
    for (int n = column * nodes; n < (column + 1) * nodes; ++n)
      for (int k = 0; k < 3; ++k) b[i++] = static_cast<float>(g[n][k]);
  factor_.solve(b, threads_);
  z.resize(g.size());
  i = 0;
  for (int column : at)
    for (int n = column * nodes; n < (column + 1) * nodes; ++n)
      for (int k = 0; k < 3; ++k) z[n][k] = static_cast<double>(b[i++]);
}

std::size_t HessianFactor::bytes() const { return factor_.bytes(); }

}  // namespace condyle
