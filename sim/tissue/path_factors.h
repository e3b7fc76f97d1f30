#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "engine/tissue/hessian_factor.h"
#include "sim/tissue/model.h"

namespace condyle {

/// Preconditioners at the knots of a model's opening path, for solves without an earlier one. The
/// tissue of the lower face rotates with the jaw: a factor of the unrotated tissue needs several
/// times the iterations. Each is made at its first use and then kept. Thread-safe.
class PathFactors {
 public:
  /// Follows the path of the model as it is solved. `threads`: of factorizations and solves.
  PathFactors(const TissueModel& model, int threads);

  /// Of the knot nearest to an opening (rad) of the jaw. The same bits whichever were made before.
  std::shared_ptr<const HessianFactor> nearest(double turned_rad) const;

  int made() const;
  int most() const;  // one for each knot of the path
  /// Memory of those that were made, with their patterns and work space.
  std::size_t bytes() const;
  std::size_t bytes_of_one() const;

 private:
  using Factor = std::shared_ptr<const HessianFactor>;
  Factor make(std::size_t knot) const;
  Factor of(std::size_t knot) const;

  int threads_;
  std::shared_ptr<const TissueMesh> mesh_;
  std::shared_ptr<const TissueContact> contact_;
  std::shared_ptr<const PlannedRest> planned_;
  std::shared_ptr<const OpeningPath> path_;
  std::vector<BodyId> along_;

  mutable std::mutex mutex_;
  mutable std::vector<Factor> of_knot_;  // null: not made yet
};

}  // namespace condyle
