#pragma once

#include <array>
#include <type_traits>

namespace condyle {

/// Derivatives of a prism's volume as polynomials of its corners relative to corner 0 ([0] is
/// zero). V: vectors of three numbers; `cross`: their cross product.
///
/// Twelve times the volume is, with (pqr) for a determinant,
/// (134) + (214) + (245) + (215) + (145) + (253) - 2 (345): floor, then both splits of each side.
template <class V, class Cross>
void prism_volume_slopes(const std::array<V, 6>& c, const Cross& cross, std::array<V, 6>& g) {
  using Number = std::decay_t<decltype(c[0][0])>;
  constexpr Number scale = Number(1) / Number(12);
  const V c45 = cross(c[4], c[5]), c12 = cross(c[1], c[2]);
  const V sum = c[4] + c[5], lean = c[1] + c[2] - 2 * c[3];
  g[1] = scale * (cross(c[3], c[4]) + cross(sum, c[2]) + c45);
  g[2] = scale * (cross(c[1], sum) + c45 + cross(c[5], c[3]));
  g[3] = scale * (cross(c[4], c[1]) + cross(c[2], c[5]) - 2 * c45);
  g[4] = scale * (cross(c[5], lean) + cross(c[1], c[3]) - c12);
  g[5] = scale * (cross(lean, c[4]) + cross(c[3], c[2]) - c12);
  g[0] = -(g[1] + g[2] + g[3] + g[4] + g[5]);
}

/// The second derivative with respect to corners a > b is the matrix of the product u x v: returns
/// u at [a (a - 1) / 2 + b], times 12 * `scale`.
template <class V, class Number>
std::array<V, 15> prism_volume_bends(const std::array<V, 6>& c, Number scale) {
  // From the slopes: the derivative of p x q is -(q x) by p and (p x) by q.
  std::array<V, 15> bend;
  const auto of = [&](int a, int b) -> V& { return bend[a * (a - 1) / 2 + b]; };
  of(2, 1) = -scale * (c[4] + c[5]);
  of(3, 1) = scale * c[4];
  of(4, 1) = scale * (c[2] + c[5] - c[3]);
  of(5, 1) = scale * (c[2] - c[4]);
  of(3, 2) = -scale * c[5];
  of(4, 2) = scale * (c[5] - c[1]);
  of(5, 2) = scale * (c[3] - c[1] - c[4]);
  of(4, 3) = scale * (c[1] - 2 * c[5]);
  of(5, 3) = scale * (2 * c[4] - c[2]);
  of(5, 4) = scale * (c[1] + c[2] - 2 * c[3]);
  of(1, 0) = of(2, 1) + of(3, 1) + of(4, 1) + of(5, 1);  // the rows sum to zero
  of(2, 0) = -of(2, 1) + of(3, 2) + of(4, 2) + of(5, 2);
  of(3, 0) = -of(3, 1) - of(3, 2) + of(4, 3) + of(5, 3);
  of(4, 0) = -of(4, 1) - of(4, 2) - of(4, 3) + of(5, 4);
  of(5, 0) = -of(5, 1) - of(5, 2) - of(5, 3) - of(5, 4);
  return bend;
}

}  // namespace condyle
