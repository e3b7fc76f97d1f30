#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "engine/tissue/block_cholesky.h"
#include "engine/tissue/hessian_assembly.h"

namespace condyle {

/// The Hessian of a mesh at one state in the format of other libraries, with the values of the
/// engine's own factor: assembled in single precision, stored here in double.
class HessianSystem {
 public:
  /// The Gauss-Newton matrix, which is positive definite. Does not keep its arguments.
  HessianSystem(const SpringPrismMesh& mesh, const MeshLoads& loads, int nodes_per_column,
                const Nodes& x);

  /// Lower triangle, 3 N x 3 N for N nodes in the mesh's order, without entries that are zero.
  const Eigen::SparseMatrix<double>& lower() const { return lower_; }

  /// The engine's factor of these values, yet to be computed.
  BlockCholesky empty_factor() const { return BlockCholesky(pattern_.tree); }
  /// Computes it; the assembly of the values is a copy. Returns the number of raised pivots.
  int factorize(BlockCholesky& factor, int threads) const;

 private:
  HessianPattern pattern_;
  std::vector<float> panels_;
  Eigen::SparseMatrix<double> lower_;
};

}  // namespace condyle
