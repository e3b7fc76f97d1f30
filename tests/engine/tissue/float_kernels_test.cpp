#include "engine/tissue/float_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "tests/engine/tissue/random_numbers.h"

namespace condyle {
namespace {

/// Each instruction set of this processor: fused ones are bit-identical to each other.
class FloatKernelsTest : public testing::TestWithParam<const FloatKernels*> {
 protected:
  const FloatKernels& kernels = *GetParam();
  const FrontKernels& fronts(int block) const { return kernels.fronts[block / 3 - 1]; }
  float fused(float a, float b, float c) const {
    return kernels.fused ? std::fma(a, b, c) : a * b + c;
  }
};
INSTANTIATE_TEST_SUITE_P(EachKind, FloatKernelsTest, testing::ValuesIn(usable_float_kernels()));

/// A front of random numbers as BlockCholesky leaves it: D^-1 in its diagonal blocks, L below.
struct RandomFront {
  RandomFront(const FrontKernels& kernels, int block, int blocks_eliminated, int blocks_below)
      : size(block), pivots(blocks_eliminated), height((pivots + blocks_below) * size) {
    panel = random_numbers(static_cast<std::size_t>(pivots * size) * height + 16);
    for (int c = 0; c < pivots * size; ++c)
      for (int r = c / size * size; r < c; ++r) panel[c * height + r] = 0;
    std::ptrdiff_t tiles = 0;
    for (int p = 0; p < pivots; ++p) tiles += front_tiles(p * size, height, size);
    A.resize(tiles);
    kernels.pack(panel.data(), pivots, height, A.data());
  }
  float panel_at(int row, int column) const { return panel[column * height + row]; }
  /// Expected content of the tiles.
  double target(int row, int column) const {
    const int block = column / size * size;
    if (row < block) return 0;
    if (row < block + size) return -panel_at(row, column);
    double sum = 0;
    for (int k = column; k < block + size; ++k)
      sum += static_cast<double>(panel_at(row, k)) * panel_at(k, column);
    return sum;
  }
  /// Their actual content.
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

TEST_P(FloatKernelsTest, FrontsKeepEachNumberToEightBits) {
  for (int size : {3, 6, 9, 12, 15, 18}) {
    const RandomFront front(fronts(size), size, 3, 4);
    for (int c = 0; c < front.pivots * size; ++c)
      for (int r = c / size * size / 16 * 16; r < front.height; ++r) {
        const double reference = front.target(r, c);
        EXPECT_NEAR(front.held(r, c), reference, std::ldexp(std::abs(reference), -8) + 1e-6)
            << size << ' ' << r << ' ' << c;
        if (reference == 0) {
          EXPECT_LE(std::abs(front.held(r, c)), std::ldexp(1.0, -39));
        }
      }
  }
}

TEST_P(FloatKernelsTest, FrontsHugeAndTinyNumbersStayFinite) {
  RandomFront front(fronts(6), 6, 1, 1);
  int k = 0;
  for (auto& v : front.panel) v = std::ldexp(v, k++ % 2 ? 60 : -120);
  fronts(6).pack(front.panel.data(), 1, front.height, front.A.data());
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < front.height; ++r) {
      EXPECT_TRUE(std::isfinite(front.held(r, c)));
      if (std::abs(front.target(r, c)) > 1) {
        EXPECT_NEAR(front.held(r, c) / front.target(r, c), 1, 1.0 / 256);
      }
    }
}

TEST_P(FloatKernelsTest, FrontsAreBitIdenticalToPlainLoops) {
  for (int size : {3, 6, 9, 12, 15, 18})
    for (const auto& [pivots, below] : {std::pair{1, 0}, {1, 4}, {2, 3}, {5, 7}}) {
      const RandomFront front(fronts(size), size, pivots, below);
      const int width = pivots * size, height = front.height, tiles = (height + 15) / 16;
      struct alignas(64) Tile {
        float row[16];
      };
      std::vector<Tile> room(tiles);
      float* y = room[0].row;
      const std::vector<float> given = random_numbers(height);
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
      fronts(size).forward(front.A.data(), pivots, height, y);
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
      fronts(size).backward(front.A.data(), pivots, height, y);
      for (int r = 0; r < height; ++r) EXPECT_EQ(y[r], expected[r]) << size << ' ' << r;
    }
}

TEST_P(FloatKernelsTest, ABlockTimesItsInverseFactorsIsOne) {
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
    EXPECT_EQ(given[size], 7.0f);  // the gap between the columns is unchanged
  }
}

TEST_P(FloatKernelsTest, AreBitIdenticalToPlainLoops) {
  for (int rows : {1, 12, 16, 37, 64})
    for (int columns : {1, 5, 6, 12, 18}) {
      const int depth = columns + 3;
      const auto size = [](int r, int c) { return static_cast<std::size_t>(r) * c + 16; };
      const std::vector<float> A = random_numbers(size(rows, depth));
      const std::vector<float> B = random_numbers(size(columns, depth) + 1);
      std::vector<float> C = random_numbers(size(rows, columns)), expected = C;
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

TEST_P(FloatKernelsTest, AProductIntoAnyTargetEqualsOneIntoZeros) {
  for (const auto& [rows, columns, depth] : {std::array{7, 5, 12}, {31, 31, 12}, {250, 131, 250}})
    for (const bool lower : {false, true}) {
      const std::vector<float> A = random_numbers(static_cast<std::size_t>(rows) * depth + 16);
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

TEST_P(FloatKernelsTest, ProductsOfLimitedDepthAreBitIdenticalInParts) {
  constexpr int rows = 200, columns = 200, depth = FloatKernels::max_whole_depth, width = 48;
  const std::vector<float> A = random_numbers(static_cast<std::size_t>(rows) * depth + 16);
  std::vector<float> whole(static_cast<std::size_t>(rows) * columns + 16, 0.0f), parts = whole;
  kernels.subtract_product(
      {whole.data(), A.data(), A.data(), rows, columns, depth, rows, rows, rows, false});
  for (int j = 0; j < columns; j += width)
    kernels.subtract_product({parts.data() + j * rows, A.data(), A.data() + j, rows,
                              std::min(width, columns - j), depth, rows, rows, rows, false});
  EXPECT_EQ(whole, parts);
}

TEST_P(FloatKernelsTest, LargeProductsAreThoseOfPlainLoops) {
  for (const bool lower : {false, true}) {
    const int columns = 131, rows = lower ? columns : 250, depth = 250;
    const auto size = [](int r, int c) { return static_cast<std::size_t>(r) * c + 16; };
    const std::vector<float> A = random_numbers(size(std::max(rows, columns), depth));
    std::vector<float> C = random_numbers(size(rows, columns));
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
        const double reference = static_cast<double>(before[j * rows + i]) - sum;
        error = std::max(error, std::abs(static_cast<double>(C[j * rows + i]) - reference));
        most = std::max(most, std::abs(reference));
      }
    EXPECT_LT(error, 1e-5 * most);
    EXPECT_GT(most, 10);
    for (std::size_t i = static_cast<std::size_t>(rows) * columns; i < C.size(); ++i)
      EXPECT_EQ(C[i], before[i]);  // nothing is written beyond
  }
}

TEST(FloatKernels, FusedKernelsAreBitIdentical) {
  constexpr int pivots = 5, below = 7;
  const FloatKernels& widest = float_kernels();
  for (const FloatKernels* other : usable_float_kernels()) {
    if (other == &widest || !other->fused) continue;
    for (int size : {3, 6, 9, 12, 15, 18}) {
      const auto words = [&](const FloatKernels& kernels) {
        const RandomFront front(kernels.fronts[size / 3 - 1], size, pivots, below);
        std::vector<std::uint32_t> all;
        for (const PairTile& tile : front.A) all.insert(all.end(), tile.word, tile.word + 16);
        return all;
      };
      EXPECT_EQ(words(*other), words(widest)) << size;
      const auto inverse = [&](const FloatKernels& kernels) {
        std::vector<float> block = random_numbers(static_cast<std::size_t>(size) * size + 15);
        for (int i = 0; i < size; ++i) block[i * size + i] += 9;
        kernels.invert_diagonal(block.data(), size, size, 1e-6f);
        return block;
      };
      EXPECT_EQ(inverse(*other), inverse(widest)) << size;
    }
    for (const auto& [rows, columns, depth] : {std::array{37, 18, 18}, {250, 131, 250}}) {
      const auto product = [&, rows = rows, columns = columns,
                            depth = depth](const FloatKernels& kernels) {
        const std::vector<float> A = random_numbers(static_cast<std::size_t>(rows) * depth + 16);
        std::vector<float> C(static_cast<std::size_t>(rows) * columns + 16, 0.0f);
        kernels.subtract_product(
            {C.data(), A.data(), A.data(), rows, columns, depth, rows, rows, rows, false});
        return C;
      };
      EXPECT_EQ(product(*other), product(widest)) << rows;
    }
  }
}

}  // namespace
}  // namespace condyle
