#include "engine/collide/box_bound.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Four = BoxBound::Four;
typedef int Mask __attribute__((vector_size(16)));

/// Of lengths, sums and turns in single precision: some ten roundings of 6e-8.
constexpr double lost = 2e-6;

Four four(const Eigen::Vector3d& v, double last) {
  return Four{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
              static_cast<float>(last)};
}

Four absolute(Four v) {
  constexpr Mask all_but_sign = {0x7fffffff, 0x7fffffff, 0x7fffffff, 0x7fffffff};
  return (Four)((Mask)v & all_but_sign);
}

/// M v, by the columns of M. The last entry is of no use, here and below.
Four times(const Four* columns, Four v) {
  return columns[0] * v[0] + columns[1] * v[1] + columns[2] * v[2];
}

void transpose(const Four* from, Four* to) {
  const Four low = __builtin_shufflevector(from[0], from[1], 0, 4, 1, 5),
             high = __builtin_shufflevector(from[0], from[1], 2, 6, 3, 7);
  to[0] = __builtin_shufflevector(low, from[2], 0, 1, 4, 4);
  to[1] = __builtin_shufflevector(low, from[2], 2, 3, 5, 5);
  to[2] = __builtin_shufflevector(high, from[2], 0, 1, 6, 6);
}

/// Length of what is above zero.
float length_above(Four v) {
  const Four above = v > 0 ? v : Four{};
  const Four squares = above * above;
  return std::sqrt(squares[0] + squares[1] + squares[2]);
}

}  // namespace

BoxBound::BoxBound(const Eigen::Vector3d& middle, const Eigen::Vector3d& half,
                   const Eigen::Matrix3d& directions, int left_child)
    : center{static_cast<float>(middle.x()), static_cast<float>(middle.y()),
             static_cast<float>(middle.z())},
      left(left_child) {
  for (int i = 0; i < 3; ++i) axes[i] = four(directions.col(i), half[i]);
}

float BoxBound::squared_radius() const {
  return axes[0][3] * axes[0][3] + axes[1][3] * axes[1][3] + axes[2][3] * axes[2][3];
}

BoxTurn::BoxTurn(const Eigen::Matrix3d& turn, const Eigen::Vector3d& shift, double reach_mm)
    : columns{four(turn.col(0), 0), four(turn.col(1), 0), four(turn.col(2), 0)},
      t(four(shift, 0)),
      uncertain_mm(static_cast<float>(lost * (reach_mm + shift.norm()))) {}

// Each box is seen in the axes of the other, where the gaps along the three axes add up by
// Pythagoras.
double gap_bound(const BoxBound& a, const BoxBound& b, const BoxTurn& X, double enough) {
  const Four between = times(X.columns, Four{b.center[0], b.center[1], b.center[2], 0}) + X.t -
                       Four{a.center[0], a.center[1], a.center[2], 0};
  const Four squares = between * between;
  const float ball_gap = std::sqrt(squares[0] + squares[1] + squares[2]) -
                         std::sqrt(a.squared_radius()) - std::sqrt(b.squared_radius()) -
                         X.uncertain_mm;
  if (ball_gap >= enough) return ball_gap;
  Four rows[3];  // of a's axes
  transpose(a.axes, rows);
  const Four axis[3] = {times(X.columns, b.axes[0]), times(X.columns, b.axes[1]),
                        times(X.columns, b.axes[2])};  // of b, in a's body
  const Four seen[3] = {absolute(times(rows, axis[0])), absolute(times(rows, axis[1])),
                        absolute(times(rows, axis[2]))};  // in a's axes
  const Four half_a = {a.axes[0][3], a.axes[1][3], a.axes[2][3], 0},
             half_b = {b.axes[0][3], b.axes[1][3], b.axes[2][3], 0};
  const Four in_a = absolute(times(rows, between)) - half_a - times(seen, half_b);
  const float gap_in_a = length_above(in_a) - X.uncertain_mm;
  if (gap_in_a >= enough) return gap_in_a;
  Four axis_rows[3], seen_rows[3];
  transpose(axis, axis_rows);
  transpose(seen, seen_rows);
  const Four in_b = absolute(times(axis_rows, between)) - half_b - times(seen_rows, half_a);
  return std::max(gap_in_a, length_above(in_b) - X.uncertain_mm);
}

}  // namespace condyle
