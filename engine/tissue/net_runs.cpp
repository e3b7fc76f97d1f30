#include "engine/tissue/net_runs.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "engine/tissue/spring_prism.h"
#ifdef __x86_64__
#include <immintrin.h>
#endif

#pragma GCC diagnostic ignored "-Wpsabi"  // no vectors are passed in or out of this file
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // of the compiler's own headers

namespace condyle {

namespace {

/// Reorders runs so that neighbours, which write to the same nodes, do not follow each other: the
/// processor would wait for what it has just stored. Halves are kept, since threads share by
/// halves.
template <class Run>
void spread(std::vector<Run>& runs, int lanes,
            std::initializer_list<std::vector<double>*> lane_values) {
  const std::size_t half = runs.size() / 2, quarter = half / 2;
  std::vector<std::size_t> order;
  for (std::size_t begin : {std::size_t{0}, half})
    for (std::size_t i = 0; i < quarter; ++i)
      for (std::size_t from : {begin + i, begin + quarter + i}) order.push_back(from);
  const std::vector<Run> given = runs;
  for (std::size_t i = 0; i < order.size(); ++i) runs[i] = given[order[i]];
  for (std::vector<double>* values : lane_values) {
    const std::vector<double> old = *values;
    for (std::size_t i = 0; i < order.size(); ++i)
      std::copy_n(old.begin() + static_cast<std::ptrdiff_t>(order[i]) * lanes, lanes,
                  values->begin() + static_cast<std::ptrdiff_t>(i) * lanes);
  }
}

}  // namespace

NetRuns::NetRuns(const SpringPrismNet& net) {
  std::vector<int> counts;  // lanes in use of each run of springs
  for (std::size_t s = 0; s < net.spring_a.size(); ++s) {
    const int a = net.spring_a[s], b = net.spring_b[s];
    if (counts.empty() || counts.back() == lanes || a != springs.back().a.first + counts.back() ||
        b != springs.back().b.first + counts.back()) {
      springs.push_back({{a}, {b}});
      rest_length.resize(springs.size() * lanes, 0.0);
      stiffness.resize(springs.size() * lanes, 0.0);
      counts.push_back(0);
    }
    const std::size_t at = (springs.size() - 1) * lanes + counts.back()++;
    rest_length[at] = net.rest_length[s];
    stiffness[at] = net.stiffness[s];
  }
  for (std::size_t p = 0; p < net.prisms.size(); ++p) {
    const auto& corner = net.prisms[p];
    bool goes_on = !prisms.empty() && prisms.back().count < lanes;
    for (int k = 0; goes_on && k < 6; ++k)
      goes_on = corner[k] == prisms.back().corner[k].first + prisms.back().count;
    if (!goes_on) {
      Prisms run{{}, 0};
      for (int k = 0; k < 6; ++k) run.corner[k].first = corner[k];
      prisms.push_back(run);
      rest_volume.resize(prisms.size() * lanes, 1.0);
      volume_weight.resize(prisms.size() * lanes, 0.0);
    }
    const std::size_t at = (prisms.size() - 1) * lanes + prisms.back().count++;
    rest_volume[at] = net.rest_volume[p];
    volume_weight[at] = net.volume_weight[p];
  }
  // Columns begin where runs of prisms have their outer corners.
  std::vector<char> begins(net.node_count + 1, 0);
  for (const Prisms& run : prisms)
    for (int k = 0; k < 3; ++k) begins[run.corner[k].first] = 1;
  const auto place = [&](Place& at, int count) {
    at.late = count < lanes && at.first > 0 && !begins[at.first] && begins[at.first - 1];
  };
  for (std::size_t r = 0; r < springs.size(); ++r) {
    place(springs[r].a, counts[r]);
    place(springs[r].b, counts[r]);
  }
  for (Prisms& run : prisms)
    for (Place& corner : run.corner) place(corner, run.count);
  // Kernels may take two runs at once, and each half of a sum may be halved: empty runs fill up.
  while (springs.size() % align != 0) springs.push_back({});
  while (prisms.size() % align != 0) prisms.push_back({{}, 0});
  rest_length.resize(springs.size() * lanes, 0.0);
  stiffness.resize(springs.size() * lanes, 0.0);
  rest_volume.resize(prisms.size() * lanes, 1.0);
  volume_weight.resize(prisms.size() * lanes, 0.0);
  spread(springs, lanes, {&rest_length, &stiffness});
  spread(prisms, lanes, {&rest_volume, &volume_weight});
}

namespace {

#define INLINE inline __attribute__((always_inline))

/// Vectors of one run.
#define CONDYLE_ONE_RUN                                                       \
  constexpr int wide = NetRuns::lanes;                                        \
  typedef double Lanes __attribute__((vector_size(wide * sizeof(double))));   \
  struct Place {                                                              \
    NetRuns::Place one;                                                       \
    Place(const NetRuns::Place& first, const NetRuns::Place&) : one(first) {} \
  };                                                                          \
  INLINE Lanes gathered(const double* row, const Place& at) {                 \
    Lanes v;                                                                  \
    std::memcpy(&v, row + at.one.first, sizeof v);                            \
    return v;                                                                 \
  }                                                                           \
  INLINE void scatter(double* row, const Place& at, const Lanes& v) {         \
    row += at.one.first - at.one.late;                                        \
    Lanes sum;                                                                \
    std::memcpy(&sum, row, sizeof sum);                                       \
    sum += at.one.late ? __builtin_shufflevector(v, v, 3, 0, 1, 2) : v;       \
    std::memcpy(row, &sum, sizeof sum);                                       \
  }                                                                           \
  INLINE auto lanes_in_use(int count, int) {                                  \
    return Lanes{0, 1, 2, 3} < static_cast<double>(count);                    \
  }                                                                           \
  INLINE bool all_above(const Lanes& v, double least) {                       \
    return v[0] > least && v[1] > least && v[2] > least && v[3] > least;      \
  }

namespace any_processor {
CONDYLE_ONE_RUN
INLINE Lanes inverse_root_of_floats(const Lanes& v) {
  const auto of = [](double s) {
    return static_cast<double>(1.0f / std::sqrt(static_cast<float>(s)));
  };
  return Lanes{of(v[0]), of(v[1]), of(v[2]), of(v[3])};
}
#include "engine/tissue/net_runs.inc"
}  // namespace any_processor

// Products and sums are fused where the processor can.
#ifdef __x86_64__
#pragma GCC push_options
#pragma GCC optimize("fp-contract=fast")
#pragma GCC target("avx2,fma")
namespace avx2 {
CONDYLE_ONE_RUN
INLINE Lanes inverse_root_of_floats(const Lanes& v) {
  return _mm256_cvtps_pd(_mm_set1_ps(1) / _mm_sqrt_ps(_mm256_cvtpd_ps(v)));
}
#include "engine/tissue/net_runs.inc"
}  // namespace avx2
#pragma GCC target("avx512f,avx512dq,avx512vl")
namespace avx512 {
constexpr int wide = 2 * NetRuns::lanes;
typedef __m512d Lanes;
struct Place {
  NetRuns::Place first, second;
};
INLINE Lanes gathered(const double* row, const Place& at) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(row + at.first.first)),
                            _mm256_loadu_pd(row + at.second.first), 1);
}
INLINE void scatter(double* row, const Place& at, const Lanes& v) {
  alignas(64) static constexpr long long turned[4][8] = {{0, 1, 2, 3, 4, 5, 6, 7},
                                                         {3, 0, 1, 2, 4, 5, 6, 7},
                                                         {0, 1, 2, 3, 7, 4, 5, 6},
                                                         {3, 0, 1, 2, 7, 4, 5, 6}};
  const Lanes placed =
      _mm512_permutexvar_pd(_mm512_load_si512(turned[at.first.late + 2 * at.second.late]), v);
  double* first = row + (at.first.first - at.first.late);
  double* second = row + (at.second.first - at.second.late);
  _mm256_storeu_pd(first, _mm256_loadu_pd(first) + _mm512_castpd512_pd256(placed));
  _mm256_storeu_pd(second, _mm256_loadu_pd(second) + _mm512_extractf64x4_pd(placed, 1));
}
INLINE auto lanes_in_use(int first, int second) {
  const Lanes lane{0, 1, 2, 3, 0, 1, 2, 3};
  const double a = first, b = second;
  return lane < Lanes{a, a, a, a, b, b, b, b};
}
INLINE bool all_above(const Lanes& v, double least) {
  return _mm512_cmp_pd_mask(v, _mm512_set1_pd(least), _CMP_GT_OQ) == 0xff;
}
INLINE Lanes inverse_root_of_floats(const Lanes& v) {
  return _mm512_cvtps_pd(_mm256_set1_ps(1) / _mm256_sqrt_ps(_mm512_cvtpd_ps(v)));
}
#include "engine/tissue/net_runs.inc"
}  // namespace avx512
#pragma GCC pop_options
#endif

#undef CONDYLE_ONE_RUN
#undef INLINE

}  // namespace

const RunKernels& run_kernels() {
#ifdef __x86_64__
  static const RunKernels& best =
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") ? avx512::kernels
      : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")        ? avx2::kernels
                                                                        : any_processor::kernels;
  return best;
#else
  return any_processor::kernels;
#endif
}

}  // namespace condyle
