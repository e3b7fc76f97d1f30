#include "tools/bench/baseline/hessian_system.h"

#include <algorithm>

namespace condyle {
namespace {

/// The entries of a tree's panels, in the order of the vertices.
Eigen::SparseMatrix<double> lower_triangle(const FrontTree& tree,
                                           const std::vector<float>& panels) {
  const int block = tree.block, size = block * static_cast<int>(tree.place.size());
  std::vector<Eigen::Triplet<double>> entries;
  const auto add_block = [&](const FrontTree::Front& front, int row, int column) {
    const float* from = &panels[static_cast<std::size_t>(tree.find(row, column))];
    const int height = tree.height(front);
    for (int c = 0; c < block; ++c)
      for (int r = row == column ? c : 0; r < block; ++r) {
        const float value = from[static_cast<std::ptrdiff_t>(c) * height + r];
        const int i = tree.order.at[row] * block + r, j = tree.order.at[column] * block + c;
        if (value != 0) entries.emplace_back(std::max(i, j), std::min(i, j), value);
      }
  };
  for (const FrontTree::Front& front : tree.fronts)
    for (int column = front.first; column < front.first + front.pivots; ++column) {
      for (int row = column; row < front.first + front.pivots; ++row) add_block(front, row, column);
      for (int r = front.rows_begin; r < front.rows_end; ++r)
        add_block(front, tree.rows[r], column);
    }
  Eigen::SparseMatrix<double> lower(size, size);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

}  // namespace

HessianSystem::HessianSystem(const SpringPrismMesh& mesh, const MeshLoads& loads,
                             int nodes_per_column, const Nodes& x)
    : pattern_(mesh, nodes_per_column, x), panels_(pattern_.tree->panel_floats, 0.0f) {
  HessianAssembly assembly(pattern_, mesh, loads, x, HessianKind::gauss_newton);
  for (int part = 0; part < 3; ++part) assembly.add(part, panels_.data());
  lower_ = lower_triangle(*pattern_.tree, panels_);
}

int HessianSystem::factorize(BlockCholesky& factor, int threads) const {
  const FrontTree& tree = *pattern_.tree;
  const auto begin_of = [&](int part) {
    const auto front = static_cast<std::size_t>(tree.part[part]);
    return front < tree.fronts.size() ? tree.fronts[front].panel : tree.panel_floats;
  };
  constexpr float least = 1e-6f;  // as HessianFactor
  return factor.factorize(
      [&](int part, float* values) {
        const std::size_t begin = begin_of(part);
        std::copy_n(&panels_[begin], begin_of(part + 1) - begin, values + begin);
      },
      least, threads);
}

}  // namespace condyle
