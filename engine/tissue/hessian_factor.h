#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/minimize/objective.h"
#include "engine/tissue/block_cholesky.h"
#include "engine/tissue/hessian_assembly.h"

namespace condyle {

/// Cholesky factor of a net's Hessian at one state: the preconditioner of the
/// minimiser. Compressed springs keep only their stiffness along the spring and volumes the square
/// of their gradient, so that it is positive definite. What moves is only in the right-hand side
/// (anchor targets), so a factor serves at many states; what ages it is the turning of the tissue.
/// Nodes are taken together in columns of consecutive nodes, as blocks. Single precision: it only
/// has to point the way. Same bits for any number of threads. Copies share what depends on the net
/// alone.
class HessianFactor final : public Preconditioner {
 public:
  /// nodes_per_column: 1 to 6.
  HessianFactor(const SpringPrismNet& net, const NetLoads& loads, int nodes_per_column,
                const Nodes& x, int threads = 1);

  /// The factor of another state of the same net, in the order chosen for the first. Gives the
  /// number of pivots that had to be raised: above 0 where the matrix is not positive definite.
  int refactor(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x, int threads = 1,
               Curvatures curvatures = Curvatures::gauss_newton);
  /// Another factor, of another state: of the exact curvatures where they are positive definite.
  HessianFactor another() const { return {pattern_, factor_.another()}; }  // yet to be factored
  HessianFactor anew(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                     int threads = 1) const;

  /// z = H^-1 g
  void solve(const Nodes& g, Nodes& z) const override;
  void set_threads(int threads) { threads_ = threads; }  // of solve

  /// Of the factor and of the work space of a solve.
  std::size_t bytes() const override;

 private:
  HessianFactor(std::shared_ptr<const HessianPattern> pattern, BlockCholesky factor);

  int threads_ = 1;
  std::shared_ptr<const HessianPattern> pattern_;
  BlockCholesky factor_;
};

}  // namespace condyle
