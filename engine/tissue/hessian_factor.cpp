#include "engine/tissue/hessian_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<std::vector<int>> column_rings(const SpringPrismNet& net, int nodes_per_column) {
  std::vector<std::vector<int>> ring(net.node_count / nodes_per_column);
  for (std::size_t s = 0; s < net.spring_a.size(); ++s) {
    const int a = net.spring_a[s] / nodes_per_column, b = net.spring_b[s] / nodes_per_column;
    if (a == b) continue;
    ring[a].push_back(b);
    ring[b].push_back(a);
  }
  for (auto& r : ring) {
    std::sort(r.begin(), r.end());
    r.erase(std::unique(r.begin(), r.end()), r.end());
  }
  return ring;
}

}  // namespace

void HessianFactor::order_columns(const SpringPrismNet& net, const Nodes& x) {
  // Nested dissection by position: halve along the longest side, put what touches the other half
  // last. Parts wait on a stack; places are given from the end.
  const auto ring = column_rings(net, nodes_per_column_);
  place_.assign(columns_, -1);
  column_at_.assign(columns_, -1);
  std::vector<int> part_of(columns_, -1);
  std::vector<std::vector<int>> parts(1);
  for (int c = 0; c < columns_; ++c) parts[0].push_back(c);
  int next_place = columns_ - 1;
  const auto take = [&](int c) {
    place_[c] = next_place;
    column_at_[next_place--] = c;
  };
  while (!parts.empty()) {
    std::vector<int> part = std::move(parts.back());
    parts.pop_back();
    if (part.size() <= 6) {
      for (int c : part) take(c);
      continue;
    }
    Vector3d low = x[part[0] * nodes_per_column_], high = low;
    for (int c : part) {
      low = low.cwiseMin(x[c * nodes_per_column_]);
      high = high.cwiseMax(x[c * nodes_per_column_]);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    std::sort(part.begin(), part.end(), [&](int a, int b) {
      const double xa = x[a * nodes_per_column_][axis], xb = x[b * nodes_per_column_][axis];
      return xa != xb ? xa < xb : a < b;
    });
    const std::size_t half = part.size() / 2;
    for (std::size_t i = 0; i < part.size(); ++i) part_of[part[i]] = i < half ? 1 : 2;
    std::vector<int> first, second, separator;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const int c = part[i];
      bool touches = false;
      if (i < half)
        for (int n : ring[c]) touches = touches || part_of[n] == 2;
      (touches ? separator : i < half ? first : second).push_back(c);
    }
    for (int c : part) part_of[c] = -1;
    for (int c : separator) take(c);
    parts.push_back(std::move(first));
    parts.push_back(std::move(second));
  }
}

void HessianFactor::find_fill(const SpringPrismNet& net) {
  const auto ring = column_rings(net, nodes_per_column_);
  std::vector<std::vector<int>> below(columns_);  // rows of each place
  std::vector<std::vector<int>> children(columns_);
  for (int j = 0; j < columns_; ++j) {
    std::set<int> rows;
    for (int n : ring[column_at_[j]])
      if (place_[n] > j) rows.insert(place_[n]);
    for (int child : children[j])
      for (int r : below[child])
        if (r > j) rows.insert(r);
    below[j].assign(rows.begin(), rows.end());
    if (!below[j].empty()) children[below[j].front()].push_back(j);
  }
  first_.assign(1, 0);
  for (int j = 0; j < columns_; ++j) {
    row_.push_back(j);
    row_.insert(row_.end(), below[j].begin(), below[j].end());
    first_.push_back(static_cast<int>(row_.size()));
  }
  blocks_.assign(row_.size() * static_cast<std::size_t>(size_) * size_, 0.0f);
}

float* HessianFactor::block(int row, int column) {
  const auto begin = row_.begin() + first_[column], end = row_.begin() + first_[column + 1];
  const auto it = std::lower_bound(begin, end, row);
  if (it == end || *it != row) return nullptr;
  return blocks_.data() + static_cast<std::size_t>(it - row_.begin()) * size_ * size_;
}

HessianFactor::HessianFactor(const SpringPrismNet& net, const NetLoads& loads, int nodes_per_column,
                             const Nodes& x)
    : nodes_per_column_(nodes_per_column),
      size_(3 * nodes_per_column),
      columns_(net.node_count / nodes_per_column) {
  order_columns(net, x);
  find_fill(net);
  refactor(net, loads, x);
}

void HessianFactor::refactor(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x) {
  std::fill(blocks_.begin(), blocks_.end(), 0.0f);
  const auto add = [&](int a, int b, const Matrix3d& m) {  // of the symmetric matrix's lower half
    const int pa = place_[a / nodes_per_column_], pb = place_[b / nodes_per_column_];
    if (pa < pb) return;
    float* to = block(pa, pb);
    const int row = 3 * (a % nodes_per_column_), column = 3 * (b % nodes_per_column_);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) to[(column + j) * size_ + row + i] += static_cast<float>(m(i, j));
  };
  const auto coupled = [&](int a, int b) {
    const int pa = place_[a / nodes_per_column_], pb = place_[b / nodes_per_column_];
    return block(std::max(pa, pb), std::min(pa, pb)) != nullptr;
  };
  const double lambda = net.lambda;
  for (std::size_t s = 0; s < net.spring_a.size(); ++s) {
    const int a = net.spring_a[s], b = net.spring_b[s];
    const Vector3d d = x[b] - x[a];
    const double length2 = d.squaredNorm();
    const double strain = 1 - net.rest_length[s] / std::sqrt(length2);
    const double tension = std::max(0.0, strain);
    // At rest a spring may yet go either way; the stretched ones are those that matter.
    const double k = 2 * lambda * net.stiffness[s] * (strain < -1e-9 ? net.compression_share : 1.0);
    Matrix3d m = (k * (1 - tension) / length2) * (d * d.transpose());
    m.diagonal().array() += k * tension;
    add(a, a, m);
    add(b, b, m);
    add(a, b, -m);
    add(b, a, -m);
  }
  for (std::size_t i = 0; i < net.anchor_node.size(); ++i)
    add(net.anchor_node[i], net.anchor_node[i],
        Matrix3d::Identity() * (2 * lambda * net.anchor_stiffness[i]));
  // Two surfaces that touch may couple columns that no spring does. Then each surface alone is
  // taken (weights of one sign), which leaves the matrix positive definite.
  for (const auto& row : loads.contacts) {
    if (row.gap(x) >= 0) continue;
    bool whole = true;
    for (int a = 0; a < row.count; ++a)
      for (int b = 0; b < a; ++b) whole = whole && coupled(row.node[a], row.node[b]);
    const Matrix3d m = row.normal * row.normal.transpose() * (2 * lambda * row.stiffness);
    for (int a = 0; a < row.count; ++a)
      for (int b = 0; b < row.count; ++b) {
        const double weight = row.weight[a] * row.weight[b];
        if (whole || weight > 0) add(row.node[a], row.node[b], weight * m);
      }
  }
  for (std::size_t p = 0; p < net.prisms.size(); ++p) {
    std::array<Vector3d, 6> slope;
    const double j = prism_volume_gradient(x, net.prisms[p], slope) / net.rest_volume[p];
    const double weight = (1 - lambda) * net.volume_weight[p] *
                          volume_stiffness(j, net.barrier_share, net.barrier_weight);
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b)
        add(net.prisms[p][a], net.prisms[p][b], weight * slope[a] * slope[b].transpose());
  }
  switch (nodes_per_column_) {
    case 1:
      factorize<3>();
      break;
    case 2:
      factorize<6>();
      break;
    case 3:
      factorize<9>();
      break;
    case 4:
      factorize<12>();
      break;
    case 6:
      factorize<18>();
      break;
    default:
      throw std::logic_error("HessianFactor: no kernel for this many nodes in a column");
  }
}

template <int B>
void HessianFactor::factorize() {
  using Block = Eigen::Matrix<float, B, B>;
  using Map = Eigen::Map<Block>;
  const auto at = [&](int entry) {
    return Map(blocks_.data() + static_cast<std::size_t>(entry) * B * B);
  };
  for (int j = 0; j < columns_; ++j) {
    const int begin = first_[j], end = first_[j + 1];
    Map diagonal = at(begin);
    // A node that nothing holds in some direction must not get an endless step.
    diagonal.diagonal().array() += 1e-4f * diagonal.diagonal().maxCoeff() + 1e-12f;
    const Block L = Eigen::LLT<Block>(diagonal).matrixL();
    Block inverse = Block::Identity();
    L.template triangularView<Eigen::Lower>().solveInPlace(inverse);
    diagonal = inverse;  // kept inverted: solving is then only products
    for (int e = begin + 1; e < end; ++e) at(e) = (at(e) * inverse.transpose()).eval();
    for (int k = begin + 1; k < end; ++k) {
      const int column = row_[k];
      int target = first_[column];
      for (int i = k; i < end; ++i) {
        while (row_[target] != row_[i]) ++target;
        at(target).noalias() -= at(i) * at(k).transpose();
      }
    }
  }
}

template <int B>
void HessianFactor::solve_blocks(const Nodes& g, Nodes& z) const {
  using Map = Eigen::Map<const Eigen::Matrix<float, B, B>>;
  using Column = Eigen::Matrix<float, B, 1>;
  std::vector<Column> y(columns_);
  for (int j = 0; j < columns_; ++j)
    y[j] = Eigen::Map<const Eigen::Matrix<double, B, 1>>(
               g[static_cast<std::size_t>(column_at_[j]) * nodes_per_column_].data())
               .template cast<float>();
  const auto at = [&](int entry) {
    return Map(blocks_.data() + static_cast<std::size_t>(entry) * B * B);
  };
  for (int j = 0; j < columns_; ++j) {
    const Column solved = at(first_[j]) * y[j];
    y[j] = solved;
    for (int e = first_[j] + 1; e < first_[j + 1]; ++e) y[row_[e]].noalias() -= at(e) * solved;
  }
  for (int j = columns_ - 1; j >= 0; --j) {
    Column sum = y[j];
    for (int e = first_[j] + 1; e < first_[j + 1]; ++e)
      sum.noalias() -= at(e).transpose() * y[row_[e]];
    y[j].noalias() = at(first_[j]).transpose() * sum;
  }
  z.resize(g.size());
  for (int j = 0; j < columns_; ++j)
    Eigen::Map<Eigen::Matrix<double, B, 1>>(
        z[static_cast<std::size_t>(column_at_[j]) * nodes_per_column_].data()) =
        y[j].template cast<double>();
}

std::size_t HessianFactor::bytes() const {
  const std::size_t work = static_cast<std::size_t>(columns_) * size_;
  return (blocks_.capacity() + work) * sizeof(float) +
         (place_.capacity() + column_at_.capacity() + first_.capacity() + row_.capacity()) *
             sizeof(int);
}

void HessianFactor::solve(const Nodes& g, Nodes& z) const {
  switch (nodes_per_column_) {
    case 1:
      return solve_blocks<3>(g, z);
    case 2:
      return solve_blocks<6>(g, z);
    case 3:
      return solve_blocks<9>(g, z);
    case 4:
      return solve_blocks<12>(g, z);
    default:
      return solve_blocks<18>(g, z);
  }
}

}  // namespace condyle
