#include <gsl/gsl_errno.h>
#include <gsl/gsl_multimin.h>

#include <cmath>

#include "tools/peers/peers.h"

namespace condyle::peers {
namespace {

// GSL's line searches do not support infinite values: a large finite one replaces them.
double finite(double value) { return std::isfinite(value) ? value : 1e12; }

double solve(const gsl_multimin_fdfminimizer_type* type, double line_tolerance,
             const TissueTarget& target, double tolerance, Nodes& x) {
  FlatEnergy energy(target);
  const std::size_t n = energy.size();
  gsl_multimin_function_fdf function;
  function.n = n;
  function.params = &energy;
  function.f = [](const gsl_vector* at, void* params) {
    return finite((*static_cast<FlatEnergy*>(params))(at->data, nullptr));
  };
  function.df = [](const gsl_vector* at, void* params, gsl_vector* gradient) {
    (*static_cast<FlatEnergy*>(params))(at->data, gradient->data);
  };
  function.fdf = [](const gsl_vector* at, void* params, double* value, gsl_vector* gradient) {
    *value = finite((*static_cast<FlatEnergy*>(params))(at->data, gradient->data));
  };
  gsl_set_error_handler_off();
  gsl_vector* start = gsl_vector_alloc(n);
  std::copy_n(x.front().data(), n, start->data);
  gsl_multimin_fdfminimizer* solver = gsl_multimin_fdfminimizer_alloc(type, n);
  gsl_multimin_fdfminimizer_set(solver, &function, start, 0.1, line_tolerance);
  for (int i = 0; i < 20000; ++i) {
    if (gsl_multimin_fdfminimizer_iterate(solver) != GSL_SUCCESS) break;
    if (gsl_multimin_test_gradient(solver->gradient, tolerance) == GSL_SUCCESS) break;
  }
  std::copy_n(solver->x->data, n, x.front().data());
  const double value = solver->f;
  gsl_multimin_fdfminimizer_free(solver);
  gsl_vector_free(start);
  return value;
}

}  // namespace

double gsl_conjugate_pr(const TissueTarget& target, double tolerance, Nodes& x) {
  return solve(gsl_multimin_fdfminimizer_conjugate_pr, 0.1, target, tolerance, x);
}
double gsl_bfgs2(const TissueTarget& target, double tolerance, Nodes& x) {
  return solve(gsl_multimin_fdfminimizer_vector_bfgs2, 0.1, target, tolerance, x);
}

}  // namespace condyle::peers
