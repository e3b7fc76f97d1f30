#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Approximate inverse of the Hessian: one Cholesky factor per column of `nodes_per_column`
/// consecutive nodes. A column's springs are by far the stiffest (short), which is why a column and
/// not a node is the block. Compressed springs keep only their stiffness along the spring, so every
/// block is positive definite.
class ColumnPreconditioner {
 public:
  ColumnPreconditioner(const SpringPrismNet& net, const NetLoads& loads, int nodes_per_column,
                       const Nodes& x);
  /// z = P^-1 g
  void apply(const Nodes& g, Nodes& z) const;

 private:
  int size_;     // unknowns per column
  int columns_;
  std::vector<double> factors_;  // size_ x size_ lower triangles, row by row, 1 / diagonal stored
};

}  // namespace condyle
