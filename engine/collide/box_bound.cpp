#include "engine/collide/box_bound.h"

#include <cmath>

#if defined(__SSE__)
#include <immintrin.h>
#endif

namespace condyle {
namespace {

using Four = FourFloats;
typedef int Mask __attribute__((vector_size(16)));

/// Relative error of lengths, sums and rotations in single precision: some ten roundings of 6e-8.
constexpr double lost = 2e-6;

Four same(double value) {
  const auto v = static_cast<float>(value);
  return Four{v, v, v, v};
}
Four of_a(const BoxPair::Two& v) { return Four{v[0], v[0], v[1], v[1]}; }
Four of_b(const BoxPair::Two& v) { return Four{v[0], v[1], v[0], v[1]}; }

Four absolute(Four v) {
  constexpr Mask all_but_sign = {0x7fffffff, 0x7fffffff, 0x7fffffff, 0x7fffffff};
  return (Four)((Mask)v & all_but_sign);
}
Four square_above_zero(Four v) {
  const Four above = v > 0 ? v : Four{};
  return above * above;
}
/// Of values that are not negative. The library's function checks each for that.
Four square_root(Four v) {
#if defined(__SSE__)
  return (Four)_mm_sqrt_ps((__m128)v);
#else
  for (int lane = 0; lane < 4; ++lane) v[lane] = std::sqrt(v[lane]);
  return v;
#endif
}
Four dot(const Four* v, const Four* w) { return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]; }

}  // namespace

void BoxPair::set(int which, const Eigen::Vector3d& middle, const Eigen::Vector3d& half_lengths,
                  const Eigen::Matrix3d& directions, int held) {
  const auto k = static_cast<std::size_t>(which);
  for (int i = 0; i < 3; ++i) {
    center[i][k] = static_cast<float>(middle[i]);
    half[i][k] = static_cast<float>(half_lengths[i]);
    for (int j = 0; j < 3; ++j) axes[i][j][k] = static_cast<float>(directions(j, i));
  }
  node[k] = held;
}

float BoxPair::squared_radius(int which) const {
  const auto k = static_cast<std::size_t>(which);
  return half[0][k] * half[0][k] + half[1][k] * half[1][k] + half[2][k] * half[2][k];
}

BoxTransform::BoxTransform(const Eigen::Matrix3d& turn, const Eigen::Vector3d& shift,
                           double reach_mm)
    : uncertain_mm(static_cast<float>(lost * (reach_mm + shift.norm()))) {
  for (int i = 0; i < 3; ++i) {
    t[i] = same(shift[i]);
    for (int j = 0; j < 3; ++j) R[i][j] = same(turn(i, j));
  }
}

// Each box is projected on the axes of the other; the gaps along the three axes combine by
// Pythagoras.
FourFloats gap_bounds(const BoxPair& a, const BoxPair& b, const BoxTransform& X) {
  Four axes_a[3][3], axes_b[3][3], between[3];  // in a's body; of each axis
  const Four center_b[3] = {of_b(b.center[0]), of_b(b.center[1]), of_b(b.center[2])};
  for (int j = 0; j < 3; ++j) between[j] = dot(X.R[j], center_b) + X.t[j] - of_a(a.center[j]);
  for (int i = 0; i < 3; ++i) {
    const Four axis[3] = {of_b(b.axes[i][0]), of_b(b.axes[i][1]), of_b(b.axes[i][2])};
    for (int j = 0; j < 3; ++j) {
      axes_a[i][j] = of_a(a.axes[i][j]);
      axes_b[i][j] = dot(X.R[j], axis);
    }
  }
  Four in_a[3], in_b[3];  // gaps along the axes
  for (int i = 0; i < 3; ++i) {
    in_a[i] = absolute(dot(axes_a[i], between)) - of_a(a.half[i]);
    in_b[i] = absolute(dot(axes_b[i], between)) - of_b(b.half[i]);
  }
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const Four seen = absolute(dot(axes_a[i], axes_b[k]));
      in_a[i] -= seen * of_b(b.half[k]);
      in_b[k] -= seen * of_a(a.half[i]);
    }
  Four square_a = {}, square_b = {};
  for (int i = 0; i < 3; ++i) {
    square_a += square_above_zero(in_a[i]);
    square_b += square_above_zero(in_b[i]);
  }
  return square_root(square_a > square_b ? square_a : square_b) - X.uncertain_mm;
}

BoxDirection::BoxDirection(const Eigen::Vector3d& direction, const Eigen::Matrix3d& R,
                           const Eigen::Vector3d& t) {
  const Eigen::Vector3d in_b = R.transpose() * direction;
  for (int i = 0; i < 3; ++i) {
    const auto u = static_cast<float>(direction[i]), v = static_cast<float>(in_b[i]);
    n[i] = Four{u, u, v, v};
  }
  const auto along = static_cast<float>(direction.dot(t));
  shift = Four{0, 0, along, along};
}

FourFloats gaps_along(const BoxPair& a, const BoxPair& b, const BoxDirection& sight,
                      float uncertain_mm) {
  const auto both = [](const BoxPair::Two& v, const BoxPair::Two& w) {
    return Four{v[0], v[1], w[0], w[1]};
  };
  Four middle = sight.shift, half = {};
  for (int i = 0; i < 3; ++i) {
    middle += sight.n[i] * both(a.center[i], b.center[i]);
    Four seen = {};
    for (int j = 0; j < 3; ++j) seen += sight.n[j] * both(a.axes[i][j], b.axes[i][j]);
    half += absolute(seen) * both(a.half[i], b.half[i]);
  }
  const Four high = middle + half,
             low = middle - half;  // of a the high values count, of b the low ones
  return Four{low[2], low[3], low[2], low[3]} - Four{high[0], high[0], high[1], high[1]} -
         uncertain_mm;
}

}  // namespace condyle
