#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace condyle {

using Points = std::vector<Eigen::Vector3d>;  // mm

/// A function of N points in space (3 N parameters) that is to be made least. It may be infinite
/// where the points must not go; the minimisers turn back there.
class Objective {
 public:
  virtual ~Objective() = default;

  virtual double value(const Points& x) = 0;
  /// The value; resizes and fills the gradient.
  virtual double value_and_gradient(const Points& x, Points& gradient) = 0;

  struct Curvature {
    double exact = 0;         // second derivative along d
    double gauss_newton = 0;  // without its negative parts, never below zero
  };
  /// Wants the last call of value_and_gradient to have been at `x`.
  virtual Curvature curvature(const Points& x, const Points& d) = 0;
};

/// An approximate inverse of the second derivatives, symmetric and positive definite.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// z = H^-1 g; resizes z.
  virtual void solve(const Points& g, Points& z) const = 0;
  virtual std::size_t bytes() const = 0;
};

}  // namespace condyle
