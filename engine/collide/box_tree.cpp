#include "engine/collide/box_tree.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Sums over corners: x, y, z, then xx, yy, zz, xy, xz, yz.
using Moments = Eigen::Matrix<double, 9, 1>;

Moments moments_of(const std::array<Vector3d, 3>& corners) {
  Moments sums = Moments::Zero();
  for (const Vector3d& p : corners) {
    sums.head<3>() += p;
    sums.segment<3>(3) += p.cwiseAbs2();
    sums.tail<3>() += Vector3d(p.x() * p.y(), p.x() * p.z(), p.y() * p.z());
  }
  return sums;
}

/// As columns, the longest first, orthonormal to rounding.
Matrix3d principal_axes(const Moments& sums, double count) {
  const Vector3d mean = sums.head<3>() / count;
  Matrix3d second;
  second << sums[3], sums[6], sums[7], sums[6], sums[4], sums[8], sums[7], sums[8], sums[5];
  const Matrix3d covariance = second / count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(covariance);
  Matrix3d axes = Matrix3d::Identity();
  const Vector3d longest = solver.eigenvectors().col(2);
  Vector3d next = solver.eigenvectors().col(1);
  next -= longest.dot(next) / longest.squaredNorm() * longest;
  // A solver that fails, as for corners in one point, leaves the axes of the coordinates.
  if (!longest.allFinite() || !next.allFinite() || next.norm() < 0.5 || longest.norm() < 0.5)
    return axes;
  axes.col(0) = longest.normalized();
  axes.col(1) = next.normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

class BoxTreeBuilder {
 public:
  BoxTreeBuilder(const TriMesh& mesh, BoxTree& tree)
      : tree_(tree), origin_(mesh.vertices[mesh.triangles.front()[0]]) {
    const std::size_t count = mesh.triangles.size();
    corners_.resize(count);
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), 0);
    for (std::size_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k)
        corners_[i][static_cast<std::size_t>(k)] = mesh.vertices[mesh.triangles[i][k]] - origin_;
    moments_.reserve(count);
    for (const auto& corners : corners_) moments_.push_back(moments_of(corners));
    key_.resize(count);
    tree_.boxes.reserve(count);
    tree_.region.reserve(count);
    tree_.boxes.emplace_back();
    tree_.region.emplace_back();
    build(0, static_cast<int>(count), 0, 0, 0, 0);
  }

 private:
  /// The box of a range of triangles, and all below it. `path`: from the root, as bits.
  void build(int first, int last, int depth, int path, std::size_t boxes, int which) {
    Moments sums = Moments::Zero();
    for (int i = first; i < last; ++i) sums += moments_[order_[i]];
    const Matrix3d axes = principal_axes(sums, 3.0 * (last - first));
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (int i = first; i < last; ++i)
      for (const Vector3d& p : corners_[order_[i]]) {
        const Vector3d along = axes.transpose() * p;
        low = low.cwiseMin(along);
        high = high.cwiseMax(along);
      }
    const Vector3d half = 0.5 * (high - low), center = origin_ + axes * (0.5 * (low + high));
    const bool leaf = last - first == 1;
    tree_.boxes[boxes].set(
        which, center, half, axes,
        leaf ? holding_triangle(order_[first]) : static_cast<int>(tree_.boxes.size()));
    tree_.reach_mm = std::max(tree_.reach_mm, center.norm() + half.norm());
    tree_.region[boxes][static_cast<std::size_t>(which)] =
        static_cast<signed char>(depth >= BoxTree::region_depth ? path : -1);
    if (leaf) return;
    const int middle = split(first, last, axes, half);
    const std::size_t inner = tree_.boxes.size();
    tree_.boxes.emplace_back();
    tree_.region.emplace_back();
    const bool above = depth < BoxTree::region_depth;
    build(first, middle, depth + 1, above ? 2 * path : path, inner, 0);
    build(middle, last, depth + 1, above ? 2 * path + 1 : path, inner, 1);
  }

  /// Divides a range in halves along the longest side of its box.
  int split(int first, int last, const Matrix3d& axes, const Vector3d& half) {
    Eigen::Index side = 0;
    half.maxCoeff(&side);
    const Vector3d along = axes.col(side);
    for (int i = first; i < last; ++i) {
      const auto& t = corners_[order_[i]];
      key_[order_[i]] = along.dot(t[0] + t[1] + t[2]);
    }
    const int middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](int i, int j) { return key_[i] != key_[j] ? key_[i] < key_[j] : i < j; });
    return middle;
  }

  BoxTree& tree_;
  Vector3d origin_;  // of the corners below: sums of squares keep their digits
  std::vector<std::array<Vector3d, 3>> corners_;
  std::vector<Moments> moments_;
  std::vector<int> order_;
  std::vector<double> key_;  // of each triangle
};

}  // namespace

BoxTree::BoxTree(const TriMesh& mesh) { BoxTreeBuilder(mesh, *this); }

}  // namespace condyle
