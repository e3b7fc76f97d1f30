#include "engine/minimize/minimize.h"

#include <array>
#include <stdexcept>

#include "engine/minimize/methods.h"

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

MinimizeResult minimize(Method method, Objective& objective, const MinimizeSettings& settings,
                        Points& x, const Preconditioner* preconditioner) {
  switch (method) {
    case Method::cg_parabolic:
    case Method::cg_derivative:
      return minimizers::conjugate_gradient(method == Method::cg_derivative, objective, settings,
                                            x);
    case Method::powell:
      return minimizers::powell(objective, settings, x);
    case Method::quasi_newton:
      return minimizers::quasi_newton(objective, settings, x);
    case Method::preconditioned:
      if (!preconditioner) throw std::logic_error("minimize: preconditioned wants a factor");
      return minimizers::preconditioned(objective, *preconditioner, settings, x);
  }
  throw std::logic_error("minimize: unknown method");
}

}  // namespace condyle
