#pragma once

#include <Eigen/Core>
#include <array>

namespace condyle {

typedef float FourFloats __attribute__((vector_size(16)));

/// The boxes of both children of a tree node, stored for fast lower bounds of the gaps to the boxes
/// of another node. FCL's own distance (between its swept rectangles) is exact but many times
/// slower, and for most pairs of boxes it suffices to know that they are far enough apart. Single
/// precision: the rounding error is subtracted from the bound.
struct alignas(64) BoxPair {
  typedef std::array<float, 2> Two;  // one of each box

  /// axes: as columns; half: half lengths along them; node: the caller's index of the contents.
  void set(int which, const Eigen::Vector3d& center, const Eigen::Vector3d& half,
           const Eigen::Matrix3d& axes, int node);

  Two center[3] = {}, half[3] = {}, axes[3][3] = {};  // coordinates; of each axis
  std::array<int, 2> node{};

  float squared_radius(int which) const;  // of the bounding sphere
};

/// The pose of body b in body a, prepared for many bounds. `reach_mm`: upper bound of the sum of
/// the distances of the boxes' corners from the origins of their bodies.
struct BoxTransform {
  BoxTransform(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double reach_mm);
  FourFloats R[3][3], t[3];  // each value four times; row, column
  float uncertain_mm;        // error of the gaps
};

/// Lower bounds of the gaps between the boxes, in this order: a's first and b's first, a's first
/// and b's second, a's second and b's first, both second.
FourFloats gap_bounds(const BoxPair& a, const BoxPair& b, const BoxTransform& X);

/// A direction from body a to body b, prepared for many bounds.
struct BoxDirection {
  BoxDirection() = default;
  /// `n`: unit, in the coordinates of a; R, t: the pose of b in a.
  BoxDirection(const Eigen::Vector3d& n, const Eigen::Matrix3d& R, const Eigen::Vector3d& t);
  FourFloats n[3] = {};   // twice in the coordinates of a, twice in those of b
  FourFloats shift = {};  // of body b along it: twice 0, twice the value
};

/// As gap_bounds, but of the gaps along the direction alone: weaker except where boxes face each
/// other along it, and faster. `uncertain_mm`: of BoxTransform.
FourFloats gaps_along(const BoxPair& a, const BoxPair& b, const BoxDirection& sight,
                      float uncertain_mm);

}  // namespace condyle
