#include "engine/tissue/spring_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The 15 distinct components of n n n n, each times the square root of its multiplicity, so that
/// sums of squares equal those of the tensor; z is across the layer. Stiffness through the
/// thickness has less weight than shear, because the volume energy contributes to it.
using Tensor = Eigen::Matrix<double, 15, 1>;
constexpr double through = 0.15;
const double six = std::sqrt(6.0), twelve = std::sqrt(12.0);

Tensor fourth_power(const Vector3d& n) {
  const double x = n.x(), y = n.y(), z = n.z(), xx = x * x, yy = y * y, zz = z * z;
  Tensor t;
  t << xx * xx, yy * yy, through * zz * zz,            //
      six * xx * yy, six * yy * zz, six * zz * xx,     //
      2 * xx * x * y, 2 * xx * x * z, 2 * yy * y * x,  //
      2 * yy * y * z, 2 * zz * z * x, 2 * zz * z * y,  //
      twelve * xx * y * z, twelve * yy * z * x, twelve * zz * x * y;
  return t;
}

}  // namespace

Vector3d across_prism(const std::array<Vector3d, 6>& c) {
  return (c[1] - c[0] + c[4] - c[3]).cross(c[2] - c[0] + c[5] - c[3]).normalized();
}

PrismWeights isotropic_weights(const std::array<Vector3d, 6>& c, double volume) {
  Eigen::Matrix3d frame;  // rows x, y, z
  const Vector3d up = across_prism(c);
  frame.row(2) = up;
  frame.row(0) = up.unitOrthogonal();
  frame.row(1) = up.cross(Vector3d(frame.row(0)));

  Eigen::Matrix<double, 15, 7> springs = Eigen::Matrix<double, 15, 7>::Zero();
  const auto add = [&](int column, int a, int b) {
    springs.col(column) += fourth_power(frame * (c[b] - c[a]).normalized());
  };
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    add(k, k, next);
    add(k, k + 3, next + 3);
    add(3 + k, k, next + 3);
    add(3 + k, next, k + 3);
    add(6, k, k + 3);
  }
  Tensor target = Tensor::Zero();
  target.head<6>() << 3, 3, 3 * through, six, six, six;  // dd + dd + dd

  // Least squares with weights >= least, regularised towards equal weights; coordinate descent,
  // which always converges.
  constexpr double even = 1, pull = 1e-4,
                   least = least_spring_weight;  // the trace is 15 over 15 springs
  const Eigen::Matrix<double, 7, 7> normal =
      springs.transpose() * springs + pull * Eigen::Matrix<double, 7, 7>::Identity();
  const Eigen::Matrix<double, 7, 1> right =
      springs.transpose() * target + Eigen::Matrix<double, 7, 1>::Constant(pull * even);
  Eigen::Matrix<double, 7, 1> w = Eigen::Matrix<double, 7, 1>::Constant(even);
  for (int sweep = 0; sweep < 400; ++sweep) {
    double change = 0;
    for (int i = 0; i < 7; ++i) {
      const double before = w[i];
      w[i] = std::max(least, before + (right[i] - normal.row(i).dot(w)) / normal(i, i));
      change = std::max(change, std::abs(w[i] - before));
    }
    if (change < 1e-6) break;
  }
  PrismWeights weights;
  for (int k = 0; k < 3; ++k) {
    weights.along[k] = volume * w[k];
    weights.diagonal[k] = volume * w[3 + k];
  }
  weights.across = volume * w[6];
  return weights;
}

}  // namespace condyle
