#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace condyle {

/// Sixteen rows of two columns of a factor, in half precision (bfloat16: the range of floats and 8
/// bits of their digits). The first column's are the lower halves of the words. The second's are
/// the whole words, read as floats: the upper halves are chosen so that they are the nearest,
/// whatever stands below. So neither has to be unpacked by more than a shift.
struct alignas(64) PairTile {
  std::uint32_t word[16];
};
/// Tiles of a block of `size` columns of a front that begins at `row` of `height`. They begin at
/// multiples of sixteen rows.
inline std::ptrdiff_t front_tiles(int row, int height, int size) {
  return static_cast<std::ptrdiff_t>((height + 15) / 16 - row / 16) * ((size + 1) / 2);
}

/// A front's factor as its solves read it, for blocks of one size. Each block of columns holds
/// -D^-1 in its own rows and L D^-1 below; L is the factor and D its diagonal block. `height` are
/// the rows of the front, of which the first `pivots` blocks are eliminated. y has room for whole
/// tiles.
struct FrontKernels {
  /// From a panel whose diagonal blocks hold D^-1. Up to 15 numbers after it are read.
  void (*pack)(const float* panel, int pivots, int height, PairTile* to);
  /// y's pivots = D^-1 (y - what is above); all other rows: what to add to them.
  void (*forward)(const PairTile* A, int pivots, int height, float* y);
  /// y's pivots = D^-T (y - what is below); y is followed by zeros.
  void (*backward)(const PairTile* A, int pivots, int height, float* y);
};

/// Products of dense matrices of floats, column by column in memory, as a factorisation
/// needs them. They use the widest vectors that the processor has; each sum is taken in an
/// order that does not depend on it, so that every processor that can fuse products and sums gives
/// the same bits. Up to 15 numbers after the last column of a matrix are read.
struct FloatKernels {
  const char* name;
  bool fused;  // products and sums are rounded once
  /// C -= A B^T: C is rows x columns (stride ldc), A rows x depth (lda), B columns x depth (ldb).
  /// With `lower`, entries above the diagonal of C may hold anything afterwards. With `anew`, C is
  /// -A B^T, whatever it held.
  struct Product {
    float* C;
    const float *A, *B;
    int rows, columns, depth;
    int ldc, lda, ldb;
    bool lower, anew = false;
  };
  /// Products no deeper than this have the same bits in parts of their columns as whole.
  static constexpr int most_whole_depth = 240;
  void (*subtract_product)(const Product& product);
  /// to += from
  void (*add)(float* to, const float* from, int count);
  /// Replaces the lower half of a positive definite block by the inverse of its Cholesky factor,
  /// with zeros above: solving is then only products. Pivots that are not above `least` times the
  /// largest diagonal entry are raised to it; gives how many were. Up to 15 numbers after its last
  /// column are read.
  int (*invert_diagonal)(float* block, int stride, int size, float least);
  /// For blocks of 3, 6, 9, 12, 15 and 18.
  const FrontKernels* fronts;
};
constexpr int largest_block = 18;  // of invert_diagonal and fronts

/// All that this processor can run, the widest vectors first.
std::span<const FloatKernels* const> runnable_float_kernels();
/// The fastest of them.
const FloatKernels& float_kernels();
inline const FrontKernels& front_kernels(int block) {
  return float_kernels().fronts[block / 3 - 1];
}

}  // namespace condyle
