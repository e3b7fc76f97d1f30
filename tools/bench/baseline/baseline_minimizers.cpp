#include "tools/bench/baseline/baseline_minimizers.h"

#include <array>
#include <stdexcept>

#include "tools/bench/baseline/methods.h"

namespace condyle {

std::span<const MethodFacts> all_methods() {
  static constexpr std::array<MethodFacts, 5> facts{{
      {Method::cg_parabolic, "cg_parabolic", "Conjugate gradient, parabolic interpolation", "N",
       true},
      {Method::cg_derivative, "cg_derivative", "Conjugate gradient, derivative based", "N", true},
      {Method::powell, "powell", "Direction set (Powell)", "N^2", false},
      {Method::quasi_newton, "quasi_newton", "Variable metric (quasi-Newton, BFGS)", "N^2", true},
      {Method::preconditioned, "condyle", "Conjugate gradient, preconditioned (Condyle)", "N log N",
       true},
  }};
  return facts;
}

MinimizeResult minimize_with(Method method, Objective& objective, const BaselineSettings& settings,
                             Points& x, const Preconditioner* preconditioner) {
  using minimizers::LineSearch;
  switch (method) {
    case Method::cg_parabolic:
      return minimizers::conjugate_gradient(LineSearch::parabolic, objective, settings, x);
    case Method::cg_derivative:
      return minimizers::conjugate_gradient(LineSearch::derivative, objective, settings, x);
    case Method::powell:
      return minimizers::powell(objective, settings, x);
    case Method::quasi_newton:
      return minimizers::quasi_newton(objective, settings, x);
    case Method::preconditioned:
      if (!preconditioner)
        throw std::logic_error("minimize_with: Method::preconditioned needs a preconditioner");
      return minimize(objective, *preconditioner, settings, x);
  }
  throw std::logic_error("minimize_with: unknown method");
}

}  // namespace condyle
