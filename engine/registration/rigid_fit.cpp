#include "engine/registration/rigid_fit.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cassert>

namespace condyle {

std::optional<Pose> rigid_fit(std::span<const Eigen::Vector3d> p_A,
                              std::span<const Eigen::Vector3d> p_B) {
  assert(p_A.size() == p_B.size());
  if (p_A.size() < 3) return std::nullopt;
  const double share = 1.0 / static_cast<double>(p_A.size());
  Eigen::Vector3d center_A = Eigen::Vector3d::Zero(), center_B = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < p_A.size(); ++i) {
    center_A += share * p_A[i];
    center_B += share * p_B[i];
  }
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < p_A.size(); ++i)
    products += (p_B[i] - center_B) * (p_A[i] - center_A).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d values = svd.singularValues();
  if (!(values[1] > 1e-9 * values[0])) return std::nullopt;
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  Pose fit;
  fit.R = Eigen::Quaterniond(rotation).normalized();
  fit.t = center_B - fit.R * center_A;
  return fit;
}

}  // namespace condyle
