#include "engine/tissue/float_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>
#ifdef __x86_64__
#include <immintrin.h>
#endif

#pragma GCC diagnostic ignored "-Wpsabi"  // no vector types cross the boundary of this file
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // false positives in the compiler's headers

namespace condyle {
namespace {

constexpr int tile_rows = 16;

#define CONDYLE_INLINE inline __attribute__((always_inline))
#define CONDYLE_UNROLL _Pragma("GCC unroll 32")  // sums stay in registers

typedef float Quarter __attribute__((vector_size(4 * sizeof(float))));

/// The four sums of four quarters.
CONDYLE_INLINE Quarter four_sums(const Quarter& a, const Quarter& b, const Quarter& c,
                                 const Quarter& d) {
  const Quarter ab = __builtin_shufflevector(a, b, 0, 1, 4, 5) +
                     __builtin_shufflevector(a, b, 2, 3, 6, 7),
                cd = __builtin_shufflevector(c, d, 0, 1, 4, 5) +
                     __builtin_shufflevector(c, d, 2, 3, 6, 7);
  return __builtin_shufflevector(ab, cd, 0, 2, 4, 6) + __builtin_shufflevector(ab, cd, 1, 3, 5, 7);
}

namespace any_processor {
constexpr int W = 4, tile_vectors = tile_rows / W;
constexpr bool fused = false;
typedef float Vector __attribute__((vector_size(W * sizeof(float))));
template <int N>
CONDYLE_INLINE void totals(const Vector (&sum)[N][tile_vectors], float* to) {
  for (int j = 0; j < N; ++j) {
    const Quarter q = (sum[j][0] + sum[j][2]) + (sum[j][1] + sum[j][3]);
    to[j] = (q[0] + q[2]) + (q[1] + q[3]);
  }
}
#include "engine/tissue/float_kernels.inc"
}  // namespace any_processor

// From here on products and sums are fused where the processor supports it.
#ifdef __x86_64__
#pragma GCC push_options
#pragma GCC optimize("fp-contract=fast")
#pragma GCC target("avx2,fma")
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#pragma clang fp contract(fast)
#endif
namespace avx2 {
constexpr int W = 8, tile_vectors = tile_rows / W;
constexpr bool fused = true;
typedef __m256 Vector;
template <int N>
CONDYLE_INLINE void totals(const Vector (&sum)[N][tile_vectors], float* to) {
  Quarter q[(N + 3) / 4 * 4]{};
  CONDYLE_UNROLL for (int j = 0; j < N; ++j) {
    const Vector half = sum[j][0] + sum[j][1];
    q[j] = _mm256_castps256_ps128(half) + _mm256_extractf128_ps(half, 1);
  }
  CONDYLE_UNROLL for (int j = 0; j < N; j += 4) {
    const Quarter four = four_sums(q[j], q[j + 1], q[j + 2], q[j + 3]);
    std::memcpy(to + j, &four, sizeof four);
  }
}
#include "engine/tissue/float_kernels.inc"
}  // namespace avx2
#pragma GCC target("avx512f,avx512bw,avx512vl")
#ifdef __clang__
#pragma clang attribute pop
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512vl,avx2,fma"))), \
                             apply_to = function)
#endif
namespace avx512 {
constexpr int W = 16, tile_vectors = tile_rows / W;
constexpr bool fused = true;
typedef __m512 Vector;
/// Sums of both halves of two vectors.
CONDYLE_INLINE Vector halves(const Vector& a, const Vector& b) {
  return _mm512_shuffle_f32x4(a, b, 0x44) + _mm512_shuffle_f32x4(a, b, 0xee);
}
/// The same of halves: the quarters of two vectors each.
CONDYLE_INLINE Vector quarters(const Vector& ab, const Vector& cd) {
  return _mm512_shuffle_f32x4(ab, cd, 0x88) + _mm512_shuffle_f32x4(ab, cd, 0xdd);
}
template <int N>
CONDYLE_INLINE void totals(const Vector (&sum)[N][1], float* to) {
  static_assert(N <= 12);
  Vector four[4]{};  // quarters of four columns each
  CONDYLE_UNROLL for (int j = 0; j < N; j += 4) {
    const Vector ab = halves(sum[j][0], sum[j + 1][0]);
    constexpr int last = N - 2;  // N is even
    const int next = j < last ? j + 2 : j;
    four[j / 4] = quarters(ab, halves(sum[next][0], sum[next + 1][0]));
  }
  const Vector P = _mm512_shuffle_ps(four[0], four[1], 0x44) +
                   _mm512_shuffle_ps(four[0], four[1], 0xee),
               Q = _mm512_shuffle_ps(four[2], four[2], 0x44) +
                   _mm512_shuffle_ps(four[2], four[2], 0xee);
  const Vector all = _mm512_shuffle_ps(P, Q, 0x88) + _mm512_shuffle_ps(P, Q, 0xdd);
  const __m512i order = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
  const Vector sums = _mm512_permutexvar_ps(order, all);
  std::memcpy(to, &sums, sizeof sums);
}
#include "engine/tissue/float_kernels.inc"
}  // namespace avx512
#pragma GCC pop_options
#ifdef __clang__
#pragma clang attribute pop
#pragma clang fp contract(off)
#endif
#endif

#undef CONDYLE_UNROLL
#undef CONDYLE_INLINE

}  // namespace

const std::vector<const FloatKernels*>& usable_float_kernels() {
  static const std::vector<const FloatKernels*> usable = [] {
    std::vector<const FloatKernels*> those;
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
      those.push_back(&avx512::kernels);
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
      those.push_back(&avx2::kernels);
#endif
    those.push_back(&any_processor::kernels);
    return those;
  }();
  return usable;
}

const FloatKernels& float_kernels() {
  static const FloatKernels& fastest = *usable_float_kernels().front();
  return fastest;
}

}  // namespace condyle
