#include <cholmod.h>
#include <dlfcn.h>

#include "engine/core/error.h"
#include "tools/factors/solvers.h"

namespace condyle::factors {
namespace {

class Cholmod final : public DirectSolver {
 public:
  Cholmod(CholmodKind kind, LowerTriangle lower) : lower_(std::move(lower)) {
    cholmod_start(&common_);
    common_.supernodal = kind == CholmodKind::supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    common_.final_ll = kind == CholmodKind::supernodal;
    matrix_.nrow = matrix_.ncol = static_cast<std::size_t>(lower_.rows());
    matrix_.nzmax = static_cast<std::size_t>(lower_.nonZeros());
    matrix_.p = lower_.outerIndexPtr();
    matrix_.i = lower_.innerIndexPtr();
    matrix_.x = lower_.valuePtr();
    matrix_.stype = -1;  // the lower triangle
    matrix_.itype = CHOLMOD_INT;
    matrix_.xtype = CHOLMOD_REAL;
    matrix_.dtype = CHOLMOD_DOUBLE;
    matrix_.sorted = matrix_.packed = 1;
  }
  ~Cholmod() override {
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_dense(&solution_, &common_);
    cholmod_free_dense(&work_, &common_);
    cholmod_free_dense(&work_of_solve_, &common_);
    cholmod_finish(&common_);
  }

  void analyse() override {
    cholmod_free_factor(&factor_, &common_);
    factor_ = cholmod_analyze(&matrix_, &common_);
    if (!factor_) throw MachineError("CHOLMOD: the analysis failed");
  }
  void factorize() override {
    if (!cholmod_factorize(&matrix_, factor_, &common_) || common_.status != CHOLMOD_OK)
      throw MachineError("CHOLMOD: the matrix is not positive definite");
  }
  void solve(const Points& g, Points& z) const override {
    z.resize(g.size());
    cholmod_dense right{};
    right.nrow = right.d = right.nzmax = 3 * g.size();
    right.ncol = 1;
    right.x = const_cast<double*>(g.front().data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    // Work space is kept from solve to solve.
    cholmod_solve2(CHOLMOD_A, factor_, &right, nullptr, &solution_, nullptr, &work_,
                   &work_of_solve_, &common_);
    std::copy_n(static_cast<const double*>(solution_->x), 3 * g.size(), z.front().data());
  }
  std::size_t bytes() const override { return common_.memory_inuse; }

 private:
  LowerTriangle lower_;
  cholmod_sparse matrix_{};
  cholmod_factor* factor_ = nullptr;
  mutable cholmod_dense *solution_ = nullptr, *work_ = nullptr, *work_of_solve_ = nullptr;
  mutable cholmod_common common_{};
};

}  // namespace

std::unique_ptr<DirectSolver> make_cholmod(CholmodKind kind, const LowerTriangle& lower) {
  return std::make_unique<Cholmod>(kind, lower);
}

std::string blas_name() { return dlsym(RTLD_DEFAULT, "openblas_get_config") ? "OpenBLAS" : "BLAS"; }

}  // namespace condyle::factors
