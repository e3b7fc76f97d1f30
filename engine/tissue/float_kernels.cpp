#include "engine/tissue/float_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>
#ifdef __x86_64__
#include <immintrin.h>
#endif

#pragma GCC diagnostic ignored "-Wpsabi"  // no vectors are passed in or out of this file
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // of the compiler's own headers

namespace condyle {
namespace {

constexpr int tile_rows = 16;

#define CONDYLE_INLINE inline __attribute__((always_inline))
#define CONDYLE_UNROLL _Pragma("GCC unroll 8")  // sums stay in registers

typedef float Quarter __attribute__((vector_size(4 * sizeof(float))));

namespace any_processor {
constexpr int W = 4;
typedef float Vector __attribute__((vector_size(W * sizeof(float))));
CONDYLE_INLINE Vector widened(const ShortFloat* from) {
  return Vector{float_of(from[0]), float_of(from[1]), float_of(from[2]), float_of(from[3])};
}
CONDYLE_INLINE Quarter folded(const Vector* sum) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); }
#include "engine/tissue/float_kernels.inc"
}  // namespace any_processor

// Products and sums are fused where the processor can.
#ifdef __x86_64__
#pragma GCC push_options
#pragma GCC optimize("fp-contract=fast")
#pragma GCC target("avx2,fma")
namespace avx2 {
constexpr int W = 8;
typedef __m256 Vector;
CONDYLE_INLINE Vector widened(const ShortFloat* from) {
  const __m128i shorts = _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
  return _mm256_castsi256_ps(_mm256_slli_epi32(_mm256_cvtepu16_epi32(shorts), 16));
}
CONDYLE_INLINE Quarter folded(const Vector* sum) {
  const Vector half = sum[0] + sum[1];
  return _mm256_castps256_ps128(half) + _mm256_extractf128_ps(half, 1);
}
#include "engine/tissue/float_kernels.inc"
}  // namespace avx2
#pragma GCC target("avx512f,avx512bw,avx512vl")
namespace avx512 {
constexpr int W = 16;
typedef __m512 Vector;
CONDYLE_INLINE Vector widened(const ShortFloat* from) {
  const __m256i shorts = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  return _mm512_castsi512_ps(_mm512_slli_epi32(_mm512_cvtepu16_epi32(shorts), 16));
}
CONDYLE_INLINE Quarter folded(const Vector* sum) {
  const __m256 upper = _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(*sum), 1));
  const __m256 half = _mm512_castps512_ps256(*sum) + upper;
  return _mm256_castps256_ps128(half) + _mm256_extractf128_ps(half, 1);
}
#include "engine/tissue/float_kernels.inc"
}  // namespace avx512
#pragma GCC pop_options
#endif

#undef CONDYLE_UNROLL
#undef CONDYLE_INLINE

}  // namespace

const FloatKernels& float_kernels() {
#ifdef __x86_64__
  static const FloatKernels& best =
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") ? avx512::kernels
      : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")        ? avx2::kernels
                                                                        : any_processor::kernels;
  return best;
#else
  return any_processor::kernels;
#endif
}

}  // namespace condyle
