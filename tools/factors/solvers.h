#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <string>

#include "engine/minimize/objective.h"

namespace condyle::factors {

/// A direct solver of one symmetric positive definite matrix, given by its lower triangle. It is
/// also a preconditioner, so that a minimisation can use any of them.
class DirectSolver : public Preconditioner {
 public:
  virtual void analyse() = 0;    // ordering and pattern of the factor
  virtual void factorize() = 0;  // of the analysed matrix; throws: MachineError when it fails
};

using LowerTriangle = Eigen::SparseMatrix<double>;

/// CHOLMOD (SuiteSparse) with its default orderings, in double precision.
enum class CholmodKind { simplicial, supernodal };
std::unique_ptr<DirectSolver> make_cholmod(CholmodKind kind, const LowerTriangle& lower);

/// Eigen's SimplicialLDLT with approximate minimum degree order.
std::unique_ptr<DirectSolver> make_eigen_double(const LowerTriangle& lower);
std::unique_ptr<DirectSolver> make_eigen_float(const LowerTriangle& lower);

/// The library for the dense products of CHOLMOD's supernodes: "OpenBLAS" or "BLAS".
std::string blas_name();

}  // namespace condyle::factors
