#include "engine/registration/similarity_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

namespace condyle {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

struct Means {
  double weight = 0;
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
};

Means means_of(std::span<const PointPair> pairs) {
  Means means;
  for (const auto& pair : pairs) {
    means.weight += pair.weight;
    means.from += pair.weight * pair.from;
    means.to += pair.weight * pair.to;
  }
  if (means.weight > 0) {
    means.from /= means.weight;
    means.to /= means.weight;
  }
  return means;
}

}  // namespace

AffineMap AffineMap::inverse() const {
  AffineMap back;
  back.matrix = matrix.inverse();
  back.offset = -(back.matrix * offset);
  return back;
}

std::optional<AffineMap> similarity_fit(std::span<const PointPair> pairs, const ScaleRange& scale) {
  const Means means = means_of(pairs);
  if (pairs.size() < 3 || !(means.weight > 0)) return std::nullopt;
  Matrix3d products = Matrix3d::Zero();
  double spread = 0;
  for (const auto& pair : pairs) {
    const Vector3d from = pair.from - means.from;
    products += pair.weight * (pair.to - means.to) * from.transpose();
    spread += pair.weight * from.squaredNorm();
  }
  const Eigen::JacobiSVD<Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d values = svd.singularValues();
  if (!(values[1] > 1e-9 * values[0])) return std::nullopt;
  Vector3d signs = Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs.z() = -1;
  AffineMap fit;
  fit.matrix = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  fit.matrix *= std::clamp(values.dot(signs) / spread, scale.low, scale.high);
  fit.offset = means.to - fit.matrix * means.from;
  return fit;
}

std::optional<AffineMap> affine_step(std::span<const PointPair> pairs, const AffineMap& map,
                                     const AffineStiffness& stiffness) {
  using Vector12 = Eigen::Matrix<double, 12, 1>;
  using Matrix12 = Eigen::Matrix<double, 12, 12>;
  constexpr double tangential = 0.1;
  const Means means = means_of(pairs);
  if (pairs.size() < 12 || !(means.weight > 0)) return std::nullopt;
  // The map becomes matrix * (1 + strain): unknown are the strain, column by column, and the motion
  // of the centre.
  Matrix12 normal = Matrix12::Zero();
  Vector12 right = Vector12::Zero();
  double spread = 0;
  for (const auto& pair : pairs) {
    const Vector3d from = pair.from - means.from;
    const Vector3d missing = pair.to - map * pair.from;
    const Matrix3d metric = pair.weight * map.matrix.transpose() *
                            (tangential * Matrix3d::Identity() +
                             (1 - tangential) * pair.normal * pair.normal.transpose()) *
                            map.matrix;
    const Vector3d pulled = metric * map.matrix.inverse() * missing;
    const Eigen::Vector4d x(from.x(), from.y(), from.z(), 1);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) normal.block<3, 3>(3 * i, 3 * j) += x[i] * x[j] * metric;
      right.segment<3>(3 * i) += x[i] * pulled;
    }
    spread += pair.weight * from.squaredNorm() / 3;
  }
  normal.diagonal().head<9>().array() += stiffness.change * spread;
  const Eigen::JacobiSVD<Matrix3d> svd(map.matrix, Eigen::ComputeFullV);
  const Matrix3d stretch =
      svd.matrixV() * svd.singularValues().asDiagonal() * svd.matrixV().transpose();
  const double size = svd.singularValues().mean();
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 3; ++j) {
      const double held = spread * (i == 0 ? stiffness.asymmetry : stiffness.shear);
      const int ij = 3 * j + i, ji = 3 * i + j;  // unknown numbers of strain(i, j), strain(j, i)
      for (const int a : {ij, ji}) {
        for (const int b : {ij, ji}) normal(a, b) += 0.25 * held;
        right[a] -= 0.5 * held * stretch(i, j) / size;
      }
    }
  const Eigen::LDLT<Matrix12> factor(normal);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return std::nullopt;
  const Vector12 change = factor.solve(right);
  if (!change.allFinite()) return std::nullopt;
  Matrix3d strain;
  for (int i = 0; i < 3; ++i) strain.col(i) = change.segment<3>(3 * i);
  AffineMap next;
  next.matrix = map.matrix * (Matrix3d::Identity() + strain);
  next.offset = map * means.from + map.matrix * change.tail<3>() - next.matrix * means.from;
  return next;
}

}  // namespace condyle
