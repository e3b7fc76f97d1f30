#pragma once

#include "tools/bench/baseline/tissue_target.h"

/// Minimisers of other libraries on the same energy, from the same start. Each leaves its result in
/// x and returns the energy there; `tolerance` is the library's own, as named.
namespace condyle::peers {

/// The energy over 3 N doubles. Infinite energies are reported as such.
class FlatEnergy {
 public:
  FlatEnergy(const TissueTarget& target)
      : target_(target), energy_(target.set.mesh, target.loads, 1), x_(target.start()) {}
  std::size_t size() const { return 3 * x_.size(); }
  /// gradient may be null.
  double operator()(const double* x, double* gradient);

 private:
  const TissueTarget& target_;
  SpringPrismEnergy energy_;
  Nodes x_, gradient_;
};

/// tolerance: of the gradient's norm, N.
double gsl_conjugate_pr(const TissueTarget& target, double tolerance, Nodes& x);
double gsl_bfgs2(const TissueTarget& target, double tolerance, Nodes& x);
/// tolerance: of the largest entry of the gradient, N.
double ceres_nonlinear_cg(const TissueTarget& target, double tolerance, Nodes& x);
double ceres_lbfgs(const TissueTarget& target, double tolerance, Nodes& x);
/// tolerance: relative, of the energy's last fall, times 1e-4.
double nlopt_lbfgs(const TissueTarget& target, double tolerance, Nodes& x);

}  // namespace condyle::peers
