#include "engine/tissue/net_runs.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "engine/tissue/spring_prism.h"
#ifdef __x86_64__
#include <immintrin.h>
#endif

#pragma GCC diagnostic ignored "-Wpsabi"  // no vectors are passed in or out of this file

namespace condyle {

NetRuns::NetRuns(const SpringPrismNet& net) {
  int count = 0;  // in the run
  for (std::size_t s = 0; s < net.spring_a.size(); ++s) {
    const int a = net.spring_a[s], b = net.spring_b[s];
    if (count == 0 || count == lanes || a != springs.back().a + count ||
        b != springs.back().b + count) {
      springs.push_back({a, b});
      rest_length.resize(springs.size() * lanes, 0.0);
      stiffness.resize(springs.size() * lanes, 0.0);
      count = 0;
    }
    const std::size_t at = (springs.size() - 1) * lanes + count++;
    rest_length[at] = net.rest_length[s];
    stiffness[at] = net.stiffness[s];
  }
  for (std::size_t p = 0; p < net.prisms.size(); ++p) {
    const auto& corner = net.prisms[p];
    bool goes_on = !prisms.empty() && prisms.back().count < lanes;
    for (int k = 0; goes_on && k < 6; ++k)
      goes_on = corner[k] == prisms.back().corner[k] + prisms.back().count;
    if (!goes_on) {
      prisms.push_back({corner, 0});
      rest_volume.resize(prisms.size() * lanes, 1.0);
      volume_weight.resize(prisms.size() * lanes, 0.0);
    }
    const std::size_t at = (prisms.size() - 1) * lanes + prisms.back().count++;
    rest_volume[at] = net.rest_volume[p];
    volume_weight[at] = net.volume_weight[p];
  }
}

namespace {

typedef double Lanes __attribute__((vector_size(NetRuns::lanes * sizeof(double))));

#define INLINE inline __attribute__((always_inline))

namespace any_processor {
INLINE Lanes square_root(const Lanes& v) {
  return Lanes{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
}
#include "engine/tissue/net_runs.inc"
}  // namespace any_processor

#ifdef __x86_64__
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
INLINE Lanes square_root(const Lanes& v) { return _mm256_sqrt_pd(v); }
#include "engine/tissue/net_runs.inc"
}  // namespace avx2
#pragma GCC pop_options
#endif

#undef INLINE

}  // namespace

const RunKernels& run_kernels() {
#ifdef __x86_64__
  static const RunKernels& best =
      __builtin_cpu_supports("avx2") ? avx2::kernels : any_processor::kernels;
  return best;
#else
  return any_processor::kernels;
#endif
}

}  // namespace condyle
