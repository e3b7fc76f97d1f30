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

std::optional<AffineMap> affine_fit(std::span<const PointPair> pairs, const AffineMap& prior,
                                    double pull) {
  const Means means = means_of(pairs);
  if (pairs.size() < 4 || !(means.weight > 0)) return std::nullopt;
  Matrix3d from_from = Matrix3d::Zero(), to_from = Matrix3d::Zero();
  for (const auto& pair : pairs) {
    const Vector3d from = pair.from - means.from;
    from_from += pair.weight * from * from.transpose();
    to_from += pair.weight * (pair.to - means.to) * from.transpose();
  }
  const Matrix3d held = pull * from_from.trace() / 3 * Matrix3d::Identity();
  const Eigen::LDLT<Matrix3d> factor(from_from + held);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return std::nullopt;
  AffineMap fit;
  fit.matrix = factor.solve((to_from + prior.matrix * held).transpose()).transpose();
  fit.offset = means.to - fit.matrix * means.from;
  if (!fit.matrix.allFinite()) return std::nullopt;
  return fit;
}

}  // namespace condyle
