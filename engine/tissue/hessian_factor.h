#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/minimize/objective.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Cholesky factor of a net's Gauss-Newton Hessian at one state: the preconditioner of the
/// minimiser. Compressed springs keep only their stiffness along the spring and volumes the square
/// of their gradient, so that it is positive definite. What moves is only in the right-hand side
/// (anchor targets), so a factor serves at many states; what ages it is the turning of the tissue.
/// Nodes are taken together in columns of consecutive nodes, as blocks; columns in nested
/// dissection order. Single precision: it only has to point the way.
class HessianFactor final : public Preconditioner {
 public:
  /// nodes_per_column: 2 to 4, or 6, or 1.
  HessianFactor(const SpringPrismNet& net, const NetLoads& loads, int nodes_per_column,
                const Nodes& x);

  /// The factor of another state of the same net, in the order chosen for the first.
  void refactor(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x);

  /// z = H^-1 g
  void solve(const Nodes& g, Nodes& z) const override;

  /// Of the factor and of the work space of a solve.
  std::size_t bytes() const override;

 private:
  void order_columns(const SpringPrismNet& net, const Nodes& x);
  void find_fill(const SpringPrismNet& net);
  template <int B>
  void factorize();
  template <int B>
  void solve_blocks(const Nodes& g, Nodes& z) const;
  float* block(int row, int column);  // of columns' places in the order; null when not there

  int nodes_per_column_, size_, columns_;
  std::vector<int> place_, column_at_;  // column <-> place in the elimination order
  std::vector<int> first_;              // place -> range in row_ and blocks_; diagonal block first
  std::vector<int> row_;                // rising within a range
  std::vector<float> blocks_;           // size_ x size_ each, column by column
};

}  // namespace condyle
