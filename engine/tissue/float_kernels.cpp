#include "engine/tissue/float_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

namespace condyle {
namespace {

// W floats that the processor takes at once. The code below is compiled once for each width, in
// functions that may use the instructions of that width.
template <int W>
struct Lanes {
  typedef float Vector __attribute__((vector_size(W * sizeof(float))));
};

#define CONDYLE_INLINE inline __attribute__((always_inline))

#define CONDYLE_UNROLL _Pragma("GCC unroll 8")  // sums stay in registers

constexpr int tile_rows = 16;

template <class Vector>
CONDYLE_INLINE void load(const float* from, Vector& to) {
  std::memcpy(&to, from, sizeof to);
}

/// A tile of 16 rows (`rows` of them wanted) and J columns.
template <int W, int J>
CONDYLE_INLINE void product_tile(float* C, int ldc, const float* A, int lda, const float* B,
                                 int ldb, int depth, int rows) {
  using Vector = typename Lanes<W>::Vector;
  constexpr int parts = tile_rows / W;
  Vector sum[J][parts];
  CONDYLE_UNROLL for (int j = 0; j < J; ++j) CONDYLE_UNROLL for (int p = 0; p < parts; ++p)
      sum[j][p] = Vector{};
  for (int k = 0; k < depth; ++k) {
    Vector a[parts];
    CONDYLE_UNROLL for (int p = 0; p < parts; ++p)
        load(A + static_cast<std::ptrdiff_t>(k) * lda + p * W, a[p]);
    CONDYLE_UNROLL for (int j = 0; j < J; ++j) {
      const float b = B[static_cast<std::ptrdiff_t>(k) * ldb + j];
      CONDYLE_UNROLL for (int p = 0; p < parts; ++p) sum[j][p] += a[p] * b;
    }
  }
  CONDYLE_UNROLL for (int j = 0; j < J; ++j) {
    float* to = C + static_cast<std::ptrdiff_t>(j) * ldc;
    if (rows >= tile_rows) {
      CONDYLE_UNROLL for (int p = 0; p < parts; ++p) {
        Vector c;
        load(to + p * W, c);
        c -= sum[j][p];
        std::memcpy(to + p * W, &c, sizeof c);
      }
    } else {
      float part[tile_rows];
      CONDYLE_UNROLL for (int p = 0; p < parts; ++p) {
        const Vector s = sum[j][p];
        std::memcpy(part + p * W, &s, sizeof s);
      }
      for (int i = 0; i < rows; ++i) to[i] -= part[i];
    }
  }
}

constexpr int strip = 6;  // columns of a tile of packed matrices; it has 2 W rows

/// C -= A B^T for a packed tile of A (2 W rows) and strip of B; `rows`, `columns` of it wanted.
template <int W>
CONDYLE_INLINE void packed_tile(float* C, int ldc, const float* A, const float* B, int depth,
                                int rows, int columns) {
  using Vector = typename Lanes<W>::Vector;
  Vector sum[strip][2];
  CONDYLE_UNROLL for (int j = 0; j < strip; ++j) sum[j][0] = sum[j][1] = Vector{};
  for (int k = 0; k < depth; ++k, A += 2 * W, B += strip) {
    Vector a, b;
    load(A, a);
    load(A + W, b);
    CONDYLE_UNROLL for (int j = 0; j < strip; ++j) {
      sum[j][0] += a * B[j];
      sum[j][1] += b * B[j];
    }
  }
  CONDYLE_UNROLL for (int j = 0; j < strip; ++j) {
    if (j >= columns) break;
    float* to = C + static_cast<std::ptrdiff_t>(j) * ldc;
    if (rows >= 2 * W) {
      CONDYLE_UNROLL for (int part = 0; part < 2; ++part) {
        Vector c;
        load(to + part * W, c);
        c -= sum[j][part];
        std::memcpy(to + part * W, &c, sizeof c);
      }
    } else {
      float part[2 * W];
      std::memcpy(part, &sum[j], sizeof part);
      for (int i = 0; i < rows; ++i) to[i] -= part[i];
    }
  }
}

/// Copies rows x depth of a matrix to strips of `width` rows, depth by depth, the last one filled
/// up with zeros.
CONDYLE_INLINE void pack(const float* from, int ld, int rows, int depth, int width, float* to) {
  for (int k = 0; k < depth; ++k, from += ld)
    for (int i = 0; i < rows; i += width) {
      float* at =
          to + static_cast<std::ptrdiff_t>(i) * depth + static_cast<std::ptrdiff_t>(k) * width;
      const int count = std::min(width, rows - i);
      for (int r = 0; r < count; ++r) at[r] = from[i + r];
      for (int r = count; r < width; ++r) at[r] = 0;
    }
}

/// Large products: parts of A and B that fit the caches are copied to where they are read in order.
template <int W>
CONDYLE_INLINE void packed_product(const FloatKernels::Product& p) {
  constexpr int most_depth = 240, most_rows = 192, most_columns = 480, tile = 2 * W;
  thread_local std::vector<float> A_pack(most_depth * most_rows), B_pack(most_depth * most_columns);
  for (int k = 0; k < p.depth; k += most_depth) {
    const int depth = std::min(most_depth, p.depth - k);
    for (int j = 0; j < p.columns; j += most_columns) {
      const int columns = std::min(most_columns, p.columns - j);
      pack(p.B + static_cast<std::ptrdiff_t>(k) * p.ldb + j, p.ldb, columns, depth, strip,
           B_pack.data());
      for (int i = p.lower ? j / tile * tile : 0; i < p.rows; i += most_rows) {
        const int rows = std::min(most_rows, p.rows - i);
        pack(p.A + static_cast<std::ptrdiff_t>(k) * p.lda + i, p.lda, rows, depth, tile,
             A_pack.data());
        for (int c = 0; c < columns; c += strip)
          for (int r = 0; r < rows; r += tile) {
            if (p.lower && i + r + tile <= j + c) continue;
            packed_tile<W>(p.C + static_cast<std::ptrdiff_t>(j + c) * p.ldc + i + r, p.ldc,
                           A_pack.data() + static_cast<std::ptrdiff_t>(r) * depth,
                           B_pack.data() + static_cast<std::ptrdiff_t>(c) * depth, depth, rows - r,
                           columns - c);
          }
      }
    }
  }
}

template <int W>
CONDYLE_INLINE void subtract_product(const FloatKernels::Product& p) {
  if (p.depth >= 48 && p.columns >= 96) return packed_product<W>(p);
  constexpr int width = 6;
  for (int j = 0; j < p.columns; j += width) {
    const float* B = p.B + j;
    for (int i = p.lower ? j / tile_rows * tile_rows : 0; i < p.rows; i += tile_rows) {
      float* C = p.C + static_cast<std::ptrdiff_t>(j) * p.ldc + i;
      const float* A = p.A + i;
      const int rows = p.rows - i;
      switch (std::min(width, p.columns - j)) {
        case 6:
          product_tile<W, 6>(C, p.ldc, A, p.lda, B, p.ldb, p.depth, rows);
          break;
        case 5:
          product_tile<W, 5>(C, p.ldc, A, p.lda, B, p.ldb, p.depth, rows);
          break;
        case 4:
          product_tile<W, 4>(C, p.ldc, A, p.lda, B, p.ldb, p.depth, rows);
          break;
        case 3:
          product_tile<W, 3>(C, p.ldc, A, p.lda, B, p.ldb, p.depth, rows);
          break;
        case 2:
          product_tile<W, 2>(C, p.ldc, A, p.lda, B, p.ldb, p.depth, rows);
          break;
        default:
          product_tile<W, 1>(C, p.ldc, A, p.lda, B, p.ldb, p.depth, rows);
      }
    }
  }
}

template <int W>
CONDYLE_INLINE void subtract_times(float* y, const float* A, int lda, int rows, int columns,
                                   const float* x) {
  using Vector = typename Lanes<W>::Vector;
  constexpr int parts = tile_rows / W;
  for (int i = 0; i < rows; i += tile_rows) {
    Vector sum[parts];
    CONDYLE_UNROLL for (int p = 0; p < parts; ++p) sum[p] = Vector{};
    for (int j = 0; j < columns; ++j) CONDYLE_UNROLL for (int p = 0; p < parts; ++p) {
        Vector a;
        load(A + static_cast<std::ptrdiff_t>(j) * lda + i + p * W, a);
        sum[p] += a * x[j];
      }
    CONDYLE_UNROLL for (int p = 0; p < parts; ++p) {
      Vector v;
      load(y + i + p * W, v);
      v -= sum[p];
      std::memcpy(y + i + p * W, &v, sizeof v);
    }
  }
}

/// Sixteen sums side by side for each of J columns, then added up by halves.
template <int W, int J>
CONDYLE_INLINE void dot_columns(float* y, const float* A, int lda, int rows, const float* x) {
  using Vector = typename Lanes<W>::Vector;
  using Quarter = Lanes<4>::Vector;
  constexpr int parts = tile_rows / W;
  Vector sum[J][parts];
  CONDYLE_UNROLL for (int j = 0; j < J; ++j) CONDYLE_UNROLL for (int p = 0; p < parts; ++p)
      sum[j][p] = Vector{};
  for (int i = 0; i < rows; i += tile_rows) CONDYLE_UNROLL for (int p = 0; p < parts; ++p) {
      Vector v;
      load(x + i + p * W, v);
      CONDYLE_UNROLL for (int j = 0; j < J; ++j) {
        Vector a;
        load(A + static_cast<std::ptrdiff_t>(j) * lda + i + p * W, a);
        sum[j][p] += a * v;
      }
    }
  CONDYLE_UNROLL for (int j = 0; j < J; ++j) {
    Quarter q[4];
    std::memcpy(q, &sum[j], sizeof q);
    const Quarter s = (q[0] + q[2]) + (q[1] + q[3]);
    y[j] -= (s[0] + s[2]) + (s[1] + s[3]);
  }
}

template <int W>
CONDYLE_INLINE void subtract_transposed(float* y, const float* A, int lda, int rows, int columns,
                                        const float* x) {
  int j = 0;
  for (; j + 6 <= columns; j += 6)
    dot_columns<W, 6>(y + j, A + static_cast<std::ptrdiff_t>(j) * lda, lda, rows, x);
  for (; j < columns; ++j)
    dot_columns<W, 1>(y + j, A + static_cast<std::ptrdiff_t>(j) * lda, lda, rows, x);
}

template <int W>
CONDYLE_INLINE void add(float* to, const float* from, int count) {
  using Vector = typename Lanes<W>::Vector;
  int i = 0;
  for (; i + W <= count; i += W) {
    Vector a, b;
    load(to + i, a);
    load(from + i, b);
    a += b;
    std::memcpy(to + i, &a, sizeof a);
  }
  for (; i < count; ++i) to[i] += from[i];
}

#define CONDYLE_KERNELS(name, width, ...)                                                      \
  __VA_ARGS__ void product_##name(const FloatKernels::Product& product) {                      \
    subtract_product<width>(product);                                                          \
  }                                                                                            \
  __VA_ARGS__ void times_##name(float* y, const float* A, int lda, int rows, int columns,      \
                                const float* x) {                                              \
    subtract_times<width>(y, A, lda, rows, columns, x);                                        \
  }                                                                                            \
  __VA_ARGS__ void transposed_##name(float* y, const float* A, int lda, int rows, int columns, \
                                     const float* x) {                                         \
    subtract_transposed<width>(y, A, lda, rows, columns, x);                                   \
  }                                                                                            \
  __VA_ARGS__ void add_##name(float* to, const float* from, int count) {                       \
    add<width>(to, from, count);                                                               \
  }                                                                                            \
  constexpr FloatKernels name{product_##name, times_##name, transposed_##name, add_##name};

CONDYLE_KERNELS(any_processor, 4)
#ifdef __x86_64__
CONDYLE_KERNELS(avx2, 8, __attribute__((target("avx2"))))
CONDYLE_KERNELS(avx512, 16, __attribute__((target("avx512f"))))
#endif

#undef CONDYLE_KERNELS
#undef CONDYLE_UNROLL
#undef CONDYLE_INLINE

}  // namespace

const FloatKernels& float_kernels() {
#ifdef __x86_64__
  static const FloatKernels& best = __builtin_cpu_supports("avx512f") ? avx512
                                    : __builtin_cpu_supports("avx2")  ? avx2
                                                                      : any_processor;
  return best;
#else
  return any_processor;
#endif
}

}  // namespace condyle
