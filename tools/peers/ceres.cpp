#include <ceres/ceres.h>

#include <cmath>

#include "tools/peers/peers.h"

namespace condyle::peers {
namespace {

class Function final : public ceres::FirstOrderFunction {
 public:
  explicit Function(const TissueTarget& target) : energy_(target) {}
  bool Evaluate(const double* x, double* cost, double* gradient) const override {
    *cost = energy_(x, gradient);
    return std::isfinite(*cost);
  }
  int NumParameters() const override { return static_cast<int>(energy_.size()); }

 private:
  mutable FlatEnergy energy_;
};

double solve(ceres::LineSearchDirectionType direction, const TissueTarget& target, double tolerance,
             Nodes& x) {
  const ceres::GradientProblem problem(new Function(target));
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = direction;
  options.nonlinear_conjugate_gradient_type = ceres::POLAK_RIBIERE;
  options.max_num_iterations = 20000;
  options.gradient_tolerance = tolerance;
  options.function_tolerance = 0;
  options.parameter_tolerance = 0;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, x.front().data(), &summary);
  return summary.final_cost;
}

}  // namespace

double ceres_nonlinear_cg(const TissueTarget& target, double tolerance, Nodes& x) {
  return solve(ceres::NONLINEAR_CONJUGATE_GRADIENT, target, tolerance, x);
}
double ceres_lbfgs(const TissueTarget& target, double tolerance, Nodes& x) {
  return solve(ceres::LBFGS, target, tolerance, x);
}

}  // namespace condyle::peers
