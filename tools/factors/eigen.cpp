#include <Eigen/SparseCholesky>

#include "engine/core/error.h"
#include "tools/factors/solvers.h"

namespace condyle::factors {
namespace {

template <class Number>
class SimplicialSolver final : public DirectSolver {
 public:
  explicit SimplicialSolver(const LowerTriangle& lower) : lower_(lower.cast<Number>()) {}

  void analyse() override { solver_.analyzePattern(lower_); }
  void factorize() override {
    solver_.factorize(lower_);
    if (solver_.info() != Eigen::Success) throw MachineError("Eigen: the factorisation failed");
  }
  void solve(const Points& g, Points& z) const override {
    z.resize(g.size());
    const auto size = static_cast<Eigen::Index>(3 * g.size());
    const Eigen::Map<const Eigen::VectorXd> right(g.front().data(), size);
    const Eigen::Matrix<Number, Eigen::Dynamic, 1> solution =
        solver_.solve(right.cast<Number>().eval());
    Eigen::Map<Eigen::VectorXd>(z.front().data(), size) = solution.template cast<double>();
  }
  std::size_t bytes() const override {
    return static_cast<std::size_t>(solver_.matrixL().nestedExpression().nonZeros()) *
           (sizeof(Number) + sizeof(int));
  }

 private:
  Eigen::SparseMatrix<Number> lower_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<Number>, Eigen::Lower> solver_;
};

}  // namespace

std::unique_ptr<DirectSolver> make_eigen_double(const LowerTriangle& lower) {
  return std::make_unique<SimplicialSolver<double>>(lower);
}
std::unique_ptr<DirectSolver> make_eigen_float(const LowerTriangle& lower) {
  return std::make_unique<SimplicialSolver<float>>(lower);
}

}  // namespace condyle::factors
