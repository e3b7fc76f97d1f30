#pragma once

#include <Eigen/Core>
#include <array>

namespace condyle {

typedef float FourFloats __attribute__((vector_size(16)));

/// Both children of a tree's node, for quick bounds of the gaps to those of another. FCL's own
/// (between its swept rectangles) is exact but many times slower, and most pairs of boxes need only
/// be known to be far enough. Single precision: what it loses is taken off the bound.
struct alignas(64) BoxTwins {
  typedef std::array<float, 2> Two;  // of each box one

  /// axes: columns; half: half lengths along them; node: what the box holds, as the caller numbers.
  void set(int which, const Eigen::Vector3d& center, const Eigen::Vector3d& half,
           const Eigen::Matrix3d& axes, int node);

  Two center[3] = {}, half[3] = {}, axes[3][3] = {};  // coordinates; of each axis
  std::array<int, 2> node{};

  float squared_radius(int which) const;  // of the ball around the box
};

/// The pose of b's body in a's, for many bounds. `reach_mm`: no farther are the boxes' corners from
/// the origins of their bodies, both together.
struct BoxTurn {
  BoxTurn(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double reach_mm);
  FourFloats R[3][3], t[3];  // four times the same; row, column
  float uncertain_mm;        // of gaps
};

/// No more than the gaps between the boxes: a's first and b's first, a's first and b's second, a's
/// second and b's first, both second.
FourFloats gap_bounds(const BoxTwins& a, const BoxTwins& b, const BoxTurn& X);

/// A direction of the world from a's body to b's, for many bounds.
struct BoxSight {
  BoxSight() = default;
  /// `n`: unit, in a's body; the pose of b's as above.
  BoxSight(const Eigen::Vector3d& n, const Eigen::Matrix3d& R, const Eigen::Vector3d& t);
  FourFloats n[3] = {};   // twice in a's body, twice in b's
  FourFloats shift = {};  // along it, of b's body: twice 0, twice that
};

/// The same as gap_bounds, of gaps along the direction alone: weaker but where boxes face each
/// other along it, and quick. `uncertain_mm`: of BoxTurn.
FourFloats gaps_along(const BoxTwins& a, const BoxTwins& b, const BoxSight& sight,
                      float uncertain_mm);

}  // namespace condyle
