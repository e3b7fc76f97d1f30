#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace condyle {

/// The upper half of a float (bfloat16): its range, and 8 bits of its digits.
using ShortFloat = std::uint16_t;
inline ShortFloat short_float(float v) {  // the nearest; on a tie the even one
  std::uint32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return static_cast<ShortFloat>((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}
inline float float_of(ShortFloat v) {
  const std::uint32_t bits = static_cast<std::uint32_t>(v) << 16;
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Products of dense matrices of floats, column by column in memory, as a factorisation and its
/// solves need them. They use the widest vectors that the processor has; each sum is taken in an
/// order that does not depend on it, so that every processor that can fuse products and sums gives
/// the same bits. Up to 15 numbers after the last column of a matrix are read.
struct FloatKernels {
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
  /// y -= A x; A is rows x columns (stride lda). What stands in the 15 places after y's last may
  /// hold anything afterwards.
  void (*subtract_times)(float* y, const ShortFloat* A, int lda, int rows, int columns,
                         const float* x);
  /// y -= A^T x; y has `columns` entries, x is followed by 15 zeros.
  void (*subtract_transposed)(float* y, const ShortFloat* A, int lda, int rows, int columns,
                              const float* x);
  /// to += from
  void (*add)(float* to, const float* from, int count);
  /// to = from, rounded.
  void (*narrow)(const float* from, std::size_t count, ShortFloat* to);
  /// Replaces the lower half of a positive definite block by the inverse of its Cholesky factor,
  /// with zeros above: solving is then only products. Pivots that are not above `least` times the
  /// largest diagonal entry are raised to it; gives how many were. Up to 15 numbers after its last
  /// column are read.
  int (*invert_diagonal)(float* block, int stride, int size, float least);
};
constexpr int largest_block = 18;  // of invert_diagonal

/// Those for this processor.
const FloatKernels& float_kernels();

}  // namespace condyle
