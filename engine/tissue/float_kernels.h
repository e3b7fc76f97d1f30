#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace condyle {

/// Batch16 rows of two columns of a factor, in half precision (bfloat16: the range of floats and 8
/// bits of their digits). The first column's are the lower halves of the words. The second's are
/// the whole words, read as floats: the upper halves are chosen so that they are the nearest,
/// whatever is below. So neither has to be unpacked by more than a shift.
struct alignas(64) PairTile {
  std::uint32_t word[16];
};
/// Number of tiles of a block of `size` columns of a front that begins at `row` of `height`. Tiles
/// begin at multiples of sixteen rows.
inline std::ptrdiff_t front_tiles(int row, int height, int size) {
  return static_cast<std::ptrdiff_t>((height + 15) / 16 - row / 16) * ((size + 1) / 2);
}

/// Kernels of the triangular solves of a front, for one block size. Each block of columns stores
/// -D^-1 in its own rows and L D^-1 below; L is the factor and D its diagonal block. `height`: rows
/// of the front, of which the first `pivots` blocks are eliminated. y is padded to whole tiles.
struct FrontKernels {
  /// Packs a panel whose diagonal blocks hold D^-1. Reads up to 15 numbers past its end.
  void (*pack)(const float* panel, int pivots, int height, PairTile* to);
  /// Pivot rows of y: D^-1 (y - contributions of the preceding columns); other rows: values to be
  /// added to them.
  void (*forward)(const PairTile* A, int pivots, int height, float* y);
  /// Pivot rows of y: D^-T (y - contributions of the rows below); y is padded with zeros.
  void (*backward)(const PairTile* A, int pivots, int height, float* y);
};

/// Dense single precision matrix kernels of a factorisation and its solves, column-major. They use
/// the widest vectors of the processor; the order of each sum does not depend on it, so results are
/// bit-identical on all processors with fused multiply-add. Up to 15 numbers past the last column
/// of a matrix are read.
struct FloatKernels {
  /// C -= A B^T: C is rows x columns (stride ldc), A rows x depth (lda), B columns x depth (ldb).
  /// With `lower`, entries above the diagonal of C are undefined afterwards. With `anew`, C becomes
  /// -A B^T.
  struct Product {
    float* C;
    const float *A, *B;
    int rows, columns, depth;
    int ldc, lda, ldb;
    bool lower, anew = false;
  };
  /// Up to this depth, computing a product in parts of its columns gives bit-identical results.
  static constexpr int max_whole_depth = 240;
  void (*subtract_product)(const Product& product);
  /// to += from
  void (*add)(float* to, const float* from, int count);
  /// Replaces the lower triangle of a positive definite block by the inverse of its Cholesky
  /// factor, with zeros above, so that solving needs only products. Pivots not above `least` times
  /// the largest diagonal entry are raised to that value; returns their number. Reads up to 15
  /// numbers past the last column.
  int (*invert_diagonal)(float* block, int stride, int size, float least);
  /// For blocks of 3, 6, 9, 12, 15 and 18.
  const FrontKernels* fronts;
  bool fused;  // whether fused multiply-add is used
};
constexpr int largest_block = 18;  // of invert_diagonal and fronts

/// The kernels that this processor supports, the fastest first.
const std::vector<const FloatKernels*>& usable_float_kernels();
const FloatKernels& float_kernels();  // the fastest
inline const FrontKernels& front_kernels(int block) {
  return float_kernels().fronts[block / 3 - 1];
}

}  // namespace condyle
