#include <nlopt.h>

#include <cmath>

#include "tools/peers/peers.h"

namespace condyle::peers {

double nlopt_lbfgs(const TissueTarget& target, double tolerance, Nodes& x) {
  FlatEnergy energy(target);
  nlopt_opt solver = nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(energy.size()));
  nlopt_set_min_objective(
      solver,
      [](unsigned, const double* at, double* gradient, void* data) {
        const double value = (*static_cast<FlatEnergy*>(data))(at, gradient);
        return std::isfinite(value) ? value : HUGE_VAL;
      },
      &energy);
  nlopt_set_ftol_rel(solver, 1e-4 * tolerance);
  nlopt_set_maxeval(solver, 20000);
  double value = 0;
  nlopt_optimize(solver, x.front().data(), &value);
  nlopt_destroy(solver);
  return value;
}

}  // namespace condyle::peers
