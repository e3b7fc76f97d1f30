#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/minimize/objective.h"
#include "engine/tissue/block_cholesky.h"
#include "engine/tissue/hessian_assembly.h"

namespace condyle {

/// Cholesky factor of a mesh's Hessian at one state: the preconditioner of the minimiser.
/// Compressed springs contribute only their axial stiffness and volumes the outer product of their
/// gradient, so the matrix is positive definite. Motion enters only the right-hand side (anchor
/// targets), so a factor is useful at many states; rotation of the tissue makes it less accurate.
/// Consecutive nodes are grouped in columns, as blocks. Single precision suffices for a
/// preconditioner. Deterministic for any number of threads. Copies share the data that depend on
/// the mesh alone.
class HessianFactor final : public Preconditioner {
 public:
  static constexpr int most_per_column = 6;
  /// nodes_per_column: 1 to most_per_column.
  HessianFactor(const SpringPrismMesh& mesh, const MeshLoads& loads, int nodes_per_column,
                const Nodes& x, int threads = 1);

  /// Refactors at another state of the same mesh, with the same elimination order. Returns the
  /// number of pivots that had to be raised: above 0 where the matrix is not positive definite.
  int refactor(const SpringPrismMesh& mesh, const MeshLoads& loads, const Nodes& x, int threads = 1,
               HessianKind curvatures = HessianKind::gauss_newton);
  /// anew(): a new factor at another state, of the exact Hessian where it is positive definite.
  /// another(): an empty one.
  HessianFactor another() const { return {pattern_, factor_.another()}; }  // yet to be factored
  HessianFactor anew(const SpringPrismMesh& mesh, const MeshLoads& loads, const Nodes& x,
                     int threads = 1) const;

  /// z = H^-1 g
  void solve(const Nodes& g, Nodes& z) const override;
  void set_threads(int threads) { threads_ = threads; }  // of solve

  /// Iterations of the minimizer that take about as long as a factorization. From sizes alone, so
  /// that it is the same on every machine.
  double iterations_per_factorization() const;

  /// Memory of the factor and the work space of a solve.
  std::size_t bytes() const override;
  /// Memory that it shares with its copies, beyond bytes().
  std::size_t shared_bytes() const;

 private:
  HessianFactor(std::shared_ptr<const HessianPattern> pattern, BlockCholesky factor);

  int threads_ = 1;
  std::shared_ptr<const HessianPattern> pattern_;
  BlockCholesky factor_;
};

}  // namespace condyle
