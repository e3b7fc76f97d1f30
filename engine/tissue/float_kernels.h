#pragma once

namespace condyle {

/// Products of dense matrices of floats, column by column in memory, as a factorisation and its
/// solves need them. They use the widest vectors that the processor has; each sum is taken in an
/// order that does not depend on it, so that every processor gives the same bits. Up to 15 floats
/// after the last column of a matrix are read, and must be numbers.
struct FloatKernels {
  /// C -= A B^T: C is rows x columns (stride ldc), A rows x depth (lda), B columns x depth (ldb).
  /// With `lower`, entries above the diagonal of C may hold anything afterwards.
  struct Product {
    float* C;
    const float *A, *B;
    int rows, columns, depth;
    int ldc, lda, ldb;
    bool lower;
  };
  void (*subtract_product)(const Product& product);
  /// y -= A x; A is rows x columns (stride lda). What stands in the 15 places after y's last may
  /// hold anything afterwards.
  void (*subtract_times)(float* y, const float* A, int lda, int rows, int columns, const float* x);
  /// y -= A^T x; y has `columns` entries, x is followed by 15 zeros.
  void (*subtract_transposed)(float* y, const float* A, int lda, int rows, int columns,
                              const float* x);
  /// to += from
  void (*add)(float* to, const float* from, int count);
};

/// Those for this processor.
const FloatKernels& float_kernels();

}  // namespace condyle
