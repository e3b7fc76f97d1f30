#pragma once

#include <Eigen/Core>

namespace condyle {

/// Box of a tree's node in one line of the cache, for a quick bound. FCL's own (between its swept
/// rectangles) is exact but many times slower, and most pairs of boxes need only be known to be far
/// enough. Single precision: what it loses is taken off the bound.
struct alignas(64) BoxBound {
  typedef float Four __attribute__((vector_size(16)));

  BoxBound() = default;
  /// axes: columns; half: half lengths along them; left: child, the right one follows; or what
  /// `leaf` gives.
  BoxBound(const Eigen::Vector3d& center, const Eigen::Vector3d& half, const Eigen::Matrix3d& axes,
           int left);

  Four axes[3] = {};  // each followed by the half length along it
  float center[3] = {};
  int left = -1;

  static int leaf(int triangle) { return -1 - triangle; }
  bool is_leaf() const { return left < 0; }
  int triangle() const { return -1 - left; }
  float squared_radius() const;  // of the ball around the box
};

/// The pose of b's body in a's, for many bounds. `reach_mm`: no farther are the boxes' corners from
/// the origins of their bodies, both together.
struct BoxTurn {
  BoxTurn(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double reach_mm);
  BoxBound::Four columns[3], t;  // of R
  float uncertain_mm;            // of gaps
};

/// No more than the gap between the two boxes; at least `enough` is as good as any more.
double gap_bound(const BoxBound& a, const BoxBound& b, const BoxTurn& X, double enough);

}  // namespace condyle
