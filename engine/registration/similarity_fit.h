#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace condyle {

/// x -> matrix * x + offset. mm.
struct AffineMap {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return matrix * p + offset; }
  AffineMap inverse() const;
};

/// A weighted pair of points that a map shall bring together.
struct PointPair {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  double weight = 1;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, of the surface at `to`
};

struct ScaleRange {
  double low = 1, high = 1;  // equal: the scale is fixed
};

/// Rotation, scale and translation with the least sum of squares. Absent for fewer than three
/// pairs, or points on a line. source: Umeyama, IEEE PAMI 13, 1991
std::optional<AffineMap> similarity_fit(std::span<const PointPair> pairs, const ScaleRange& scale);

/// How strongly an affine map resists, as a share of the pairs' weight.
struct AffineStiffness {
  double change = 0.004;  // against every change
  double asymmetry = 1;   // against shear of x with y or z: bodies are alike on both sides
  double shear = 0.03;    // against shear of y with z
};

/// A map nearer to the least sum of squared distances along the normals, plus a tenth of those
/// along the planes: one step from `map`. Absent where the pairs determine none.
std::optional<AffineMap> affine_step(std::span<const PointPair> pairs, const AffineMap& map,
                                     const AffineStiffness& stiffness);

}  // namespace condyle
