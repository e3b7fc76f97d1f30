#include "engine/tissue/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/engine/tissue/random_numbers.h"

namespace condyle {
namespace {

/// A grid of columns x rows with one diagonal in each cell, and a random positive definite matrix
/// of blocks on it.
struct Sparse {
  std::vector<std::vector<int>> ring;
  std::vector<Eigen::Vector3d> position;
  int block = 0;
  Eigen::MatrixXd dense;  // vertex by vertex
};

Sparse make_sparse(int columns, int rows, int block) {
  Sparse s;
  s.block = block;
  const auto at = [&](int i, int j) { return j * columns + i; };
  s.ring.resize(columns * rows);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      s.position.emplace_back(i, 1.1 * j, 0);
      for (const auto& [di, dj] : {std::pair{1, 0}, {0, 1}, {1, 1}})
        if (i + di < columns && j + dj < rows) {
          s.ring[at(i, j)].push_back(at(i + di, j + dj));
          s.ring[at(i + di, j + dj)].push_back(at(i, j));
        }
    }
  for (auto& r : s.ring) std::sort(r.begin(), r.end());
  std::mt19937 random(static_cast<unsigned>(columns + 100 * block));
  std::uniform_real_distribution<double> entry(-1, 1);
  const int n = columns * rows * block;
  s.dense.setZero(n, n);
  for (int v = 0; v < columns * rows; ++v)
    for (int w : s.ring[v])
      if (w < v) {  // each edge adds B B^T over both its ends
        Eigen::MatrixXd B(2 * block, 3);
        for (auto& b : B.reshaped()) b = entry(random);
        const Eigen::MatrixXd sum = B * B.transpose();
        s.dense.block(v * block, v * block, block, block) += sum.topLeftCorner(block, block);
        s.dense.block(w * block, w * block, block, block) += sum.bottomRightCorner(block, block);
        s.dense.block(v * block, w * block, block, block) += sum.topRightCorner(block, block);
        s.dense.block(w * block, v * block, block, block) += sum.bottomLeftCorner(block, block);
      }
  s.dense.diagonal().array() += 0.05;
  return s;
}

std::shared_ptr<const FrontTree> tree_of(const Sparse& s) {
  return std::make_shared<const FrontTree>(s.ring, elimination_order(s.ring, s.position), s.block);
}

int factorize(const Sparse& s, BlockCholesky& factor, int threads) {
  const FrontTree& tree = factor.tree();
  const int count = static_cast<int>(s.ring.size());
  return factor.factorize(
      [&](int part, float* values) {
        for (int column = tree.order.part[part]; column < tree.order.part[part + 1]; ++column)
          for (int row = column; row < count; ++row) {
            const int v = tree.order.at[row], w = tree.order.at[column];
            if (v != w && !std::binary_search(s.ring[v].begin(), s.ring[v].end(), w)) continue;
            const int stride = tree.height(tree.fronts[tree.front_of[column]]);
            float* to = values + tree.find(row, column);
            for (int j = 0; j < s.block; ++j)
              for (int i = 0; i < s.block; ++i)
                to[j * stride + i] = static_cast<float>(s.dense(v * s.block + i, w * s.block + j));
          }
      },
      1e-6f, threads);
}

TEST(BlockCholesky, SolvesAsADenseFactorDoes) {
  for (int block : {3, 6, 9, 12, 15, 18}) {
    const Sparse s = make_sparse(13, 9, block);
    BlockCholesky factor(tree_of(s));
    EXPECT_EQ(factorize(s, factor, 1), 0);
    std::vector<float> b = random_numbers(s.dense.rows());
    Eigen::VectorXd expected(b.size());
    const auto& at = factor.tree().order.at;
    for (std::size_t i = 0; i < b.size(); ++i)
      expected[at[i / block] * block + static_cast<int>(i) % block] = b[i];
    expected = s.dense.llt().solve(expected).eval();
    factor.solve(b, 1);
    double error = 0;
    for (std::size_t i = 0; i < b.size(); ++i)
      error = std::max(
          error, std::abs(b[i] - expected[at[i / block] * block + static_cast<int>(i) % block]));
    EXPECT_LT(error, 0.03 * expected.cwiseAbs().maxCoeff()) << block;  // it is stored in 8 bits
    EXPECT_GT(expected.norm(), 1);
  }
}

TEST(BlockCholesky, IsBitIdenticalForAnyNumberOfThreads) {
  const Sparse s = make_sparse(16, 12, 12);
  BlockCholesky one(tree_of(s)), two(tree_of(s));
  factorize(s, one, 1);
  factorize(s, two, 2);
  std::vector<float> a = random_numbers(s.dense.rows()), b = a;
  one.solve(a, 1);
  two.solve(b, 2);
  EXPECT_EQ(a, b);
}

TEST(BlockCholesky, ReportsAMatrixThatIsNotPositiveDefinite) {
  Sparse s = make_sparse(6, 5, 6);
  s.dense.block<6, 6>(48, 48) *= -1;
  BlockCholesky factor(tree_of(s));
  EXPECT_GT(factorize(s, factor, 1), 0);
  std::vector<float> b = random_numbers(s.dense.rows());
  factor.solve(b, 1);
  for (float v : b) EXPECT_TRUE(std::isfinite(v));
}

TEST(EliminationOrder, HalvesTouchOnlyThroughTheLastPart) {
  const Sparse s = make_sparse(20, 11, 3);
  const EliminationOrder order = elimination_order(s.ring, s.position);
  std::vector<int> part_of(s.ring.size(), -1);
  for (int p = 0; p < 3; ++p)
    for (int i = order.part[p]; i < order.part[p + 1]; ++i) part_of[order.at[i]] = p;
  EXPECT_LE(order.part[3] - order.part[2], 12);
  for (std::size_t v = 0; v < s.ring.size(); ++v) {
    ASSERT_GE(part_of[v], 0);
    for (int n : s.ring[v]) EXPECT_FALSE(part_of[v] + part_of[n] == 1);
  }
}

}  // namespace
}  // namespace condyle
