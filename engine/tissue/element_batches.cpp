#include "engine/tissue/element_batches.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "engine/tissue/spring_prism.h"
#ifdef __x86_64__
#include <immintrin.h>
#endif

#pragma GCC diagnostic ignored "-Wpsabi"  // no vector types cross the boundary of this file
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // false positives in the compiler's headers

namespace condyle {

namespace {

/// Springs or prisms with consecutive nodes, stored in a batch from `lane` on.
struct Group {
  std::size_t first = 0;
  int count = 0, lane = 0;
};

/// Reorders groups so that neighbours, which write to the same nodes, are not consecutive;
/// otherwise loads would wait for preceding stores. Kernels may process two at once and threads
/// process halves, so empty groups pad the number.
template <class T>
void spread(std::vector<T>& groups) {
  while (groups.size() % ElementBatches::align != 0) groups.push_back({});
  const std::size_t half = groups.size() / 2, quarter = half / 2;
  const std::vector<T> given = groups;
  auto to = groups.begin();
  for (std::size_t begin : {std::size_t{0}, half})
    for (std::size_t i = begin; i < begin + quarter; ++i)
      for (std::size_t from : {i, i + quarter}) *to++ = given[from];
}

/// All springs, in maximal groups of consecutive nodes.
std::vector<Group> spring_groups(const SpringPrismMesh& mesh) {
  const auto &a = mesh.spring_a, &b = mesh.spring_b;
  std::vector<Group> groups;
  for (std::size_t s = 0; s < a.size(); ++s) {
    if (!groups.empty()) {
      auto& [first, count, lane] = groups.back();
      if (a[s] == a[first] + count && b[s] == b[first] + count) {
        ++count;
        continue;
      }
    }
    groups.push_back({s, 1});
  }
  return groups;
}

void cut(const Group& group, int most, std::vector<Group>& to) {
  for (int i = 0; i < group.count; i += most)
    to.push_back({group.first + static_cast<std::size_t>(i), std::min(most, group.count - i)});
}

/// The groups of an edge by direction, the springs over all layers of four sheets (that beside the
/// rising diagonals first), and its first nodes.
struct EdgeGroups {
  std::array<Group, ElementBatches::Edge::directions> of;
  std::array<Group, 2> over;
  ElementBatches::Edge edge;
};

/// Divides an edge of a layered mesh into parts of four sheets; each begins at the last sheet of
/// the previous one.
void cut_edge(const ElementBatches::Edge& edge,
              const std::array<Group, ElementBatches::Edge::directions>& of,
              std::vector<EdgeGroups>& to) {
  constexpr int step = ElementBatches::lanes - 1;
  const int diagonals = of[ElementBatches::Edge::rising].count;
  for (int low = 0; low < diagonals; low += step) {
    const int count = std::min(step, diagonals - low), above = low > 0 ? 1 : 0;
    const auto from = [low](const Group& group) {
      return group.first + static_cast<std::size_t>(low);
    };
    to.push_back({{Group{from(of[0]) + static_cast<std::size_t>(above), count + 1 - above, above},
                   Group{from(of[1]), count}, Group{from(of[2]), count}},
                  {},
                  {edge.a + low, edge.b + low}});
  }
}

/// Gives a spring to that part of an edge, from `first` on, whose sheets it joins over all layers.
bool joins_over(const Group& group, int a, int b, std::vector<EdgeGroups>::iterator first,
                std::vector<EdgeGroups>::iterator end) {
  constexpr int across = ElementBatches::lanes - 1;
  if (group.count != 1) return false;
  for (auto part = first; part != end; ++part) {
    if (part->of[ElementBatches::Edge::rising].count != across) continue;
    const auto& [one, other] = part->edge;
    const int which = a == one + across && b == other   ? 0
                      : a == one && b == other + across ? 1
                                                        : -1;
    if (which < 0 || part->over[which].count > 0) continue;
    part->over[which] = {group.first, 1, across};
    return true;
  }
  return false;
}

}  // namespace

ElementBatches::ElementBatches(const SpringPrismMesh& mesh) {
  assert(mesh.spring_b.size() == mesh.spring_a.size() &&
         mesh.rest_length.size() == mesh.spring_a.size() &&
         mesh.stiffness.size() == mesh.spring_a.size());
  assert(mesh.rest_volume.size() == mesh.prisms.size() &&
         mesh.volume_weight.size() == mesh.prisms.size());
  batch_springs(mesh);
  batch_prisms(mesh);
}

void ElementBatches::batch_springs(const SpringPrismMesh& mesh) {
  const auto &a = mesh.spring_a, &b = mesh.spring_b;
  std::vector<EdgeGroups> of_edges;
  std::vector<Group> of_verticals, of_springs;
  const std::vector<Group> groups = spring_groups(mesh);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Group& level = groups[g];
    const auto diagonal = [&](std::size_t at, int from, int to) {
      return at < groups.size() && groups[at].count == level.count - 1 &&
             a[groups[at].first] == from && b[groups[at].first] == to;
    };
    const int one = a[level.first], other = b[level.first];
    if (diagonal(g + 1, one, other + 1) && diagonal(g + 2, other, one + 1)) {
      const auto parts = static_cast<std::ptrdiff_t>(of_edges.size());
      cut_edge({one, other}, {level, groups[g + 1], groups[g + 2]}, of_edges);
      g += 2;
      while (g + 1 < groups.size() &&
             joins_over(groups[g + 1], a[groups[g + 1].first], b[groups[g + 1].first],
                        of_edges.begin() + parts, of_edges.end()))
        ++g;
    } else if (other == one + 1) {
      cut(level, lanes - 1, of_verticals);
    } else {
      cut(level, lanes, of_springs);
    }
  }
  spread(of_edges);
  spread(of_verticals);
  spread(of_springs);
  const std::size_t all =
      of_edges.size() * Edge::directions + of_verticals.size() + of_springs.size();
  rest_length.assign(all * lanes, 0.0);
  stiffness.assign(all * lanes, 0.0);
  const auto place = [&](const Group& group, std::size_t lane) {
    for (int i = 0; i < group.count; ++i) {
      rest_length[lane + group.lane + i] = mesh.rest_length[group.first + i];
      stiffness[lane + group.lane + i] = mesh.stiffness[group.first + i];
    }
  };
  const auto ends = [&](const Group& group) {
    return group.count > 0 ? std::pair{a[group.first], b[group.first]} : std::pair{0, 0};
  };
  for (const auto& [of, over, edge] : of_edges) {
    for (int direction = 0; direction < Edge::directions; ++direction)
      place(of[direction], lane(edges.size(), static_cast<Edge::Direction>(direction)));
    place(over[0], lane(edges.size(), Edge::rising));
    place(over[1], lane(edges.size(), Edge::falling));
    edges.push_back(edge);
  }
  for (const Group& group : of_verticals) vertical_edges.push_back({ends(group).first});
  for (const Group& group : of_springs)
    spring_batches.push_back({ends(group).first, ends(group).second});
  for (std::size_t i = 0; i < vertical_edges.size(); ++i)
    place(of_verticals[i], lane_of_vertical(i));
  for (std::size_t i = 0; i < spring_batches.size(); ++i) place(of_springs[i], lane_of_springs(i));
}

void ElementBatches::batch_prisms(const SpringPrismMesh& mesh) {
  std::vector<Group> of_columns, of_prisms;
  const auto between_columns = [&](std::size_t p) {
    const auto& at = mesh.prisms[p];
    return at[3] == at[0] + 1 && at[4] == at[1] + 1 && at[5] == at[2] + 1;
  };
  for (std::size_t p = 0; p < mesh.prisms.size(); ++p) {
    const bool stack = between_columns(p);
    auto& of = stack ? of_columns : of_prisms;
    bool goes_on = !of.empty() && of.back().first + of.back().count == p &&
                   of.back().count < (stack ? lanes - 1 : lanes);
    for (int k = 0; goes_on && k < 6; ++k)
      goes_on = mesh.prisms[p][k] == mesh.prisms[of.back().first][k] + of.back().count;
    if (goes_on)
      ++of.back().count;
    else
      of.push_back({p, 1});
  }
  spread(of_columns);
  spread(of_prisms);
  const auto corners = [&](const Group& group) {
    return group.count > 0 ? mesh.prisms[group.first] : std::array<int, 6>{};
  };
  for (const Group& group : of_columns) {
    const auto at = corners(group);
    prism_columns.push_back({{at[0], at[1], at[2]}, group.count});
  }
  for (const Group& group : of_prisms) prisms.push_back({corners(group), group.count});
  for (const auto* of : {&of_columns, &of_prisms})
    for (const Group& group : *of)
      for (int i = 0; i < lanes; ++i) {
        const bool used = i < group.count;
        const double rest = used ? mesh.rest_volume[group.first + i] : 0.0;
        inverse_volume.push_back(used ? 1 / rest : 0.0);
        volume_energy.push_back(used ? mesh.volume_weight[group.first + i] * rest * rest : 0.0);
      }
}

namespace {

#define INLINE inline __attribute__((always_inline))

/// Vector type and operations for one batch.
#define CONDYLE_ONE_BATCH                                                                 \
  constexpr int wide = ElementBatches::lanes;                                             \
  typedef double Lanes __attribute__((vector_size(wide * sizeof(double))));               \
  INLINE Lanes gathered(const double* from, const double*) {                              \
    Lanes v;                                                                              \
    std::memcpy(&v, from, sizeof v);                                                      \
    return v;                                                                             \
  }                                                                                       \
  template <int>                                                                          \
  INLINE const Lanes& of_batch(const Lanes& v) {                                          \
    return v;                                                                             \
  }                                                                                       \
  INLINE void add_to(double* to, const Lanes& v) {                                        \
    Lanes sum;                                                                            \
    std::memcpy(&sum, to, sizeof sum);                                                    \
    sum += v;                                                                             \
    std::memcpy(to, &sum, sizeof sum);                                                    \
  }                                                                                       \
  INLINE Lanes next(const Lanes& v) { return __builtin_shufflevector(v, v, 1, 2, 3, 0); } \
  INLINE Lanes back(const Lanes& v) { return __builtin_shufflevector(v, v, 3, 0, 1, 2); } \
  INLINE auto lanes_in_use(int count, int) {                                              \
    return Lanes{0, 1, 2, 3} < static_cast<double>(count);                                \
  }                                                                                       \
  INLINE bool all_above(const Lanes& v, double least) {                                   \
    return v[0] > least && v[1] > least && v[2] > least && v[3] > least;                  \
  }

namespace any_processor {
CONDYLE_ONE_BATCH
INLINE Lanes inverse_root_of_floats(const Lanes& v) {
  const auto of = [](double s) {
    return static_cast<double>(1.0f / std::sqrt(static_cast<float>(s)));
  };
  return Lanes{of(v[0]), of(v[1]), of(v[2]), of(v[3])};
}
#include "engine/tissue/element_batches.inc"
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
CONDYLE_ONE_BATCH
INLINE Lanes inverse_root_of_floats(const Lanes& v) {
  return _mm256_cvtps_pd(_mm_set1_ps(1) / _mm_sqrt_ps(_mm256_cvtpd_ps(v)));
}
#include "engine/tissue/element_batches.inc"
}  // namespace avx2
#pragma GCC target("avx512f,avx512dq,avx512vl")
#ifdef __clang__
#pragma clang attribute pop
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,avx2,fma"))), \
                             apply_to = function)
#endif
namespace avx512 {
constexpr int wide = 2 * ElementBatches::lanes;
typedef __m512d Lanes;
INLINE Lanes gathered(const double* first, const double* second) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(first)), _mm256_loadu_pd(second),
                            1);
}
template <int batch>
INLINE __m256d of_batch(const Lanes& v) {
  return _mm512_extractf64x4_pd(v, batch);
}
INLINE void add_to(double* to, const __m256d& v) { _mm256_storeu_pd(to, _mm256_loadu_pd(to) + v); }
INLINE Lanes next(const Lanes& v) { return __builtin_shufflevector(v, v, 1, 2, 3, 0, 5, 6, 7, 4); }
INLINE Lanes back(const Lanes& v) { return __builtin_shufflevector(v, v, 3, 0, 1, 2, 7, 4, 5, 6); }
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
#include "engine/tissue/element_batches.inc"
}  // namespace avx512
#pragma GCC pop_options
#ifdef __clang__
#pragma clang attribute pop
#pragma clang fp contract(off)
#endif
#endif

#undef CONDYLE_ONE_BATCH
#undef INLINE

}  // namespace

const std::vector<const ElementKernels*>& usable_element_kernels() {
  static const std::vector<const ElementKernels*> usable = [] {
    std::vector<const ElementKernels*> kinds;
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
      kinds.push_back(&avx512::kernels);
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
      kinds.push_back(&avx2::kernels);
#endif
    kinds.push_back(&any_processor::kernels);
    return kinds;
  }();
  return usable;
}

}  // namespace condyle
