#include "engine/tissue/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "engine/tissue/float_kernels.h"

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

std::vector<float> right_hand_side(std::size_t size) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> entry(-1, 1);
  std::vector<float> b(size);
  for (auto& v : b) v = entry(random);
  return b;
}

TEST(BlockCholesky, SolvesAsADenseFactorDoes) {
  for (int block : {3, 6, 9, 12, 15, 18}) {
    const Sparse s = make_sparse(13, 9, block);
    BlockCholesky factor(tree_of(s));
    EXPECT_EQ(factorize(s, factor, 1), 0);
    std::vector<float> b = right_hand_side(s.dense.rows());
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
    EXPECT_LT(error, 0.03 * expected.cwiseAbs().maxCoeff()) << block;  // it is kept in 8 bits
    EXPECT_GT(expected.norm(), 1);
  }
}

TEST(BlockCholesky, SameBitsForAnyNumberOfThreads) {
  const Sparse s = make_sparse(16, 12, 12);
  BlockCholesky one(tree_of(s)), two(tree_of(s));
  factorize(s, one, 1);
  factorize(s, two, 2);
  std::vector<float> a = right_hand_side(s.dense.rows()), b = a;
  one.solve(a, 1);
  two.solve(b, 2);
  EXPECT_EQ(a, b);
}

TEST(BlockCholesky, TellsWhatIsNotPositiveDefinite) {
  Sparse s = make_sparse(6, 5, 6);
  s.dense.block<6, 6>(48, 48) *= -1;
  BlockCholesky factor(tree_of(s));
  EXPECT_GT(factorize(s, factor, 1), 0);
  std::vector<float> b = right_hand_side(s.dense.rows());
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

/// Not only those that this processor would choose.
class EachKernels : public testing::TestWithParam<const FloatKernels*> {
 protected:
  const FloatKernels& kernels = *GetParam();
  const FrontKernels& of_fronts(int block) const { return kernels.fronts[block / 3 - 1]; }
  /// a b + c, rounded as the kernels do.
  float fused(float a, float b, float c) const {
    return kernels.fused ? std::fma(a, b, c) : a * b + c;
  }
};
INSTANTIATE_TEST_SUITE_P(FloatKernels, EachKernels,
                         testing::ValuesIn(runnable_float_kernels().begin(),
                                           runnable_float_kernels().end()),
                         [](const auto& row) { return row.param->name; });

/// A front of random numbers as BlockCholesky leaves it: D^-1 in its diagonal blocks, L below.
struct RandomFront {
  RandomFront(const FrontKernels& kernels, int block, int blocks_eliminated, int blocks_below)
      : size(block), pivots(blocks_eliminated), height((pivots + blocks_below) * size) {
    panel = right_hand_side(static_cast<std::size_t>(pivots * size) * height + 16);
    for (int c = 0; c < pivots * size; ++c)
      for (int r = c / size * size; r < c; ++r) panel[c * height + r] = 0;
    std::ptrdiff_t tiles = 0;
    for (int p = 0; p < pivots; ++p) tiles += front_tiles(p * size, height, size);
    A.resize(tiles);
    kernels.pack(panel.data(), pivots, height, A.data());
  }
  float panel_at(int row, int column) const { return panel[column * height + row]; }
  /// What the tiles should hold.
  double wanted(int row, int column) const {
    const int block = column / size * size;
    if (row < block) return 0;
    if (row < block + size) return -panel_at(row, column);
    double sum = 0;
    for (int k = column; k < block + size; ++k)
      sum += static_cast<double>(panel_at(row, k)) * panel_at(k, column);
    return sum;
  }
  /// What they hold.
  float held(int row, int column) const {
    const int block = column / size * size, in_block = column - block, pairs = (size + 1) / 2;
    std::ptrdiff_t at = 0;
    for (int c = 0; c < block; c += size) at += front_tiles(c, height, size);
    at += static_cast<std::ptrdiff_t>(row / 16 - block / 16) * pairs + in_block / 2;
    std::uint32_t word = A[at].word[row % 16];
    if (in_block % 2 == 0) word <<= 16;
    float value;
    std::memcpy(&value, &word, sizeof value);
    return value;
  }
  int size, pivots, height;
  std::vector<float> panel;
  std::vector<PairTile> A;
};

TEST_P(EachKernels, KeepEachNumberToEightBits) {
  for (int size : {3, 6, 9, 12, 15, 18}) {
    const RandomFront front(of_fronts(size), size, 3, 4);
    for (int c = 0; c < front.pivots * size; ++c)
      for (int r = c / size * size / 16 * 16; r < front.height; ++r) {
        const double wanted = front.wanted(r, c);
        EXPECT_NEAR(front.held(r, c), wanted, std::ldexp(std::abs(wanted), -8) + 1e-6)
            << size << ' ' << r << ' ' << c;
        if (wanted == 0) {
          EXPECT_LE(std::abs(front.held(r, c)), std::ldexp(1.0, -39));
        }
      }
  }
}

TEST_P(EachKernels, HugeAndTinyNumbersStayFinite) {
  RandomFront front(of_fronts(6), 6, 1, 1);
  int k = 0;
  for (auto& v : front.panel) v = std::ldexp(v, k++ % 2 ? 60 : -120);
  of_fronts(6).pack(front.panel.data(), 1, front.height, front.A.data());
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < front.height; ++r) {
      EXPECT_TRUE(std::isfinite(front.held(r, c)));
      if (std::abs(front.wanted(r, c)) > 1) {
        EXPECT_NEAR(front.held(r, c) / front.wanted(r, c), 1, 1.0 / 256);
      }
    }
}

TEST_P(EachKernels, FrontsHaveTheBitsOfPlainLoops) {
  for (int size : {3, 6, 9, 12, 15, 18})
    for (const auto& [pivots, below] : {std::pair{1, 0}, {1, 4}, {2, 3}, {5, 7}}) {
      const RandomFront front(of_fronts(size), size, pivots, below);
      const int width = pivots * size, height = front.height, tiles = (height + 15) / 16;
      struct alignas(64) Tile {
        float row[16];
      };
      std::vector<Tile> room(tiles);
      float* y = room[0].row;
      const std::vector<float> given = right_hand_side(height);
      std::copy_n(given.begin(), width, y);
      std::vector<float> expected(given.begin(), given.end());
      std::fill(expected.begin() + width, expected.end(), 0.0f);
      for (int c = 0; c < width; c += size) {
        const std::vector<float> x(&expected[c], &expected[c] + size);
        std::fill_n(&expected[c], size, 0.0f);
        for (int r = c / 16 * 16; r < height; ++r) {
          std::array<float, 2> sum{};
          for (int j = 0; j < size; ++j) sum[j % 2] = fused(front.held(r, c + j), x[j], sum[j % 2]);
          expected[r] -= sum[0] + sum[1];
        }
      }
      of_fronts(size).forward(front.A.data(), pivots, height, y);
      for (int r = 0; r < height; ++r) EXPECT_EQ(y[r], expected[r]) << size << ' ' << r;

      std::copy(given.begin(), given.end(), y);
      std::fill(y + height, y + tiles * 16, 0.0f);
      expected = given;
      for (int c = width - size; c >= 0; c -= size) {
        std::vector<float> x(size);
        for (int j = 0; j < size; ++j) {
          std::array<float, 16> part{};
          for (int r = c / 16 * 16; r < height; ++r)
            part[r % 16] = fused(front.held(r, c + j), expected[r], part[r % 16]);
          for (int half = 8; half > 0; half /= 2)
            for (int i = 0; i < half; ++i) part[i] += part[i + half];
          x[j] = -part[0];
        }
        std::copy(x.begin(), x.end(), &expected[c]);
      }
      of_fronts(size).backward(front.A.data(), pivots, height, y);
      for (int r = 0; r < height; ++r) EXPECT_EQ(y[r], expected[r]) << size << ' ' << r;
    }
}

TEST_P(EachKernels, ABlockTimesItsInverseFactorsIsOne) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> entry(-1, 1);
  for (int size : {3, 6, 12, 15, 18}) {
    Eigen::MatrixXf root(size, size + 4);
    for (auto& v : root.reshaped()) v = entry(random);
    const Eigen::MatrixXf block = root * root.transpose();
    const int stride = size + 5;
    std::vector<float> given(static_cast<std::size_t>(stride) * size + 15, 7.0f);
    for (int j = 0; j < size; ++j)
      for (int i = j; i < size; ++i) given[j * stride + i] = block(i, j);
    EXPECT_EQ(kernels.invert_diagonal(given.data(), stride, size, 1e-6f), 0);
    Eigen::MatrixXf inverse(size, size);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) inverse(i, j) = given[j * stride + i];
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < j; ++i) EXPECT_EQ(inverse(i, j), 0);
    EXPECT_LT(
        (inverse * block * inverse.transpose() - Eigen::MatrixXf::Identity(size, size)).norm(),
        1e-3);
    EXPECT_EQ(given[size], 7.0f);  // what stands between the columns stays
  }
}

TEST_P(EachKernels, ProductsHaveTheBitsOfPlainLoops) {
  for (int rows : {1, 12, 16, 37, 64})
    for (int columns : {1, 5, 6, 12, 18}) {
      const int depth = columns + 3;
      const auto size = [](int r, int c) { return static_cast<std::size_t>(r) * c + 16; };
      const std::vector<float> A = right_hand_side(size(rows, depth));
      const std::vector<float> B = right_hand_side(size(columns, depth) + 1);
      std::vector<float> C = right_hand_side(size(rows, columns)), expected = C;
      kernels.subtract_product(
          {C.data(), A.data(), B.data(), rows, columns, depth, rows, rows, columns, false});
      for (int j = 0; j < columns; ++j)
        for (int i = 0; i < rows; ++i) {
          float sum = 0;
          for (int k = 0; k < depth; ++k) sum = fused(A[k * rows + i], B[k * columns + j], sum);
          expected[j * rows + i] -= sum;
        }
      EXPECT_EQ(C, expected);
    }
}

TEST_P(EachKernels, AProductAnewIsThatOfZeros) {
  for (const auto& [rows, columns, depth] : {std::array{7, 5, 12}, {31, 31, 12}, {250, 131, 250}})
    for (const bool lower : {false, true}) {
      const std::vector<float> A = right_hand_side(static_cast<std::size_t>(rows) * depth + 16);
      const auto filled = [&](float with) {
        return std::vector<float>(static_cast<std::size_t>(rows) * columns + 16, with);
      };
      std::vector<float> from_zeros = filled(0),
                         anew = filled(std::numeric_limits<float>::quiet_NaN());
      const auto product = [&, rows = rows, columns = columns, depth = depth](auto& C, bool fresh) {
        kernels.subtract_product(
            {C.data(), A.data(), A.data(), rows, columns, depth, rows, rows, rows, lower, fresh});
      };
      product(from_zeros, false);
      product(anew, true);
      for (int j = 0; j < columns; ++j)
        for (int i = lower ? j : 0; i < rows; ++i)
          EXPECT_EQ(anew[j * rows + i], from_zeros[j * rows + i]);
      EXPECT_TRUE(std::isnan(anew[static_cast<std::size_t>(rows) * columns]));
    }
}

TEST_P(EachKernels, ProductsThatAreNotTooDeepHaveTheSameBitsInParts) {
  constexpr int rows = 200, columns = 200, depth = FloatKernels::most_whole_depth, width = 48;
  const std::vector<float> A = right_hand_side(static_cast<std::size_t>(rows) * depth + 16);
  std::vector<float> whole(static_cast<std::size_t>(rows) * columns + 16, 0.0f), parts = whole;
  kernels.subtract_product(
      {whole.data(), A.data(), A.data(), rows, columns, depth, rows, rows, rows, false});
  for (int j = 0; j < columns; j += width)
    kernels.subtract_product({parts.data() + j * rows, A.data(), A.data() + j, rows,
                              std::min(width, columns - j), depth, rows, rows, rows, false});
  EXPECT_EQ(whole, parts);
}

TEST_P(EachKernels, LargeProductsAreThoseOfPlainLoops) {
  for (const bool lower : {false, true}) {
    const int columns = 131, rows = lower ? columns : 250, depth = 250;
    const auto size = [](int r, int c) { return static_cast<std::size_t>(r) * c + 16; };
    const std::vector<float> A = right_hand_side(size(std::max(rows, columns), depth));
    std::vector<float> C = right_hand_side(size(rows, columns));
    const std::vector<float> before = C;
    const int ld = rows;
    kernels.subtract_product(
        {C.data(), A.data(), A.data(), rows, columns, depth, rows, ld, ld, lower});
    double error = 0, most = 0;
    for (int j = 0; j < columns; ++j)
      for (int i = lower ? j : 0; i < rows; ++i) {
        double sum = 0;
        for (int k = 0; k < depth; ++k)
          sum += static_cast<double>(A[k * ld + i]) * static_cast<double>(A[k * ld + j]);
        const double wanted = static_cast<double>(before[j * rows + i]) - sum;
        error = std::max(error, std::abs(static_cast<double>(C[j * rows + i]) - wanted));
        most = std::max(most, std::abs(wanted));
      }
    EXPECT_LT(error, 1e-5 * most);
    EXPECT_GT(most, 10);
    for (std::size_t i = static_cast<std::size_t>(rows) * columns; i < C.size(); ++i)
      EXPECT_EQ(C[i], before[i]);  // nothing is written beyond
  }
}

TEST(FloatKernels, ThoseThatFuseGiveTheSameBits) {
  constexpr int pivots = 5, below = 7;
  const FloatKernels& widest = float_kernels();
  for (const FloatKernels* other : runnable_float_kernels()) {
    if (other == &widest || !other->fused) continue;
    for (int size : {3, 6, 9, 12, 15, 18}) {
      const auto words = [&](const FloatKernels& kernels) {
        const RandomFront front(kernels.fronts[size / 3 - 1], size, pivots, below);
        std::vector<std::uint32_t> all;
        for (const PairTile& tile : front.A) all.insert(all.end(), tile.word, tile.word + 16);
        return all;
      };
      EXPECT_EQ(words(*other), words(widest)) << other->name << ' ' << size;
      const auto inverse = [&](const FloatKernels& kernels) {
        std::vector<float> block = right_hand_side(static_cast<std::size_t>(size) * size + 15);
        for (int i = 0; i < size; ++i) block[i * size + i] += 9;
        kernels.invert_diagonal(block.data(), size, size, 1e-6f);
        return block;
      };
      EXPECT_EQ(inverse(*other), inverse(widest)) << other->name << ' ' << size;
    }
    for (const auto& [rows, columns, depth] : {std::array{37, 18, 18}, {250, 131, 250}}) {
      const auto product = [&, rows = rows, columns = columns,
                            depth = depth](const FloatKernels& kernels) {
        const std::vector<float> A = right_hand_side(static_cast<std::size_t>(rows) * depth + 16);
        std::vector<float> C(static_cast<std::size_t>(rows) * columns + 16, 0.0f);
        kernels.subtract_product(
            {C.data(), A.data(), A.data(), rows, columns, depth, rows, rows, rows, false});
        return C;
      };
      EXPECT_EQ(product(*other), product(widest)) << other->name << ' ' << rows;
    }
  }
}

}  // namespace
}  // namespace condyle
