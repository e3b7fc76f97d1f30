#include "engine/tissue/async_preconditioner.h"

#include <algorithm>
#include <cmath>

namespace condyle {

int AsyncPreconditioner::lag(const HessianFactor& factor, int frame_iterations) {
  // Frames of a steady motion take 1 iteration at 2,000 nodes, 3 at 10,000 and 10 at 50,000, the
  // younger their factor the fewer: beyond 5 frames more is lost by age than by waiting.
  const double iterations = factor.iterations_per_factorization() - 8;
  const int of_few = std::clamp(static_cast<int>(std::lround(iterations / 4)), 1, 5);
  if (frame_iterations <= 0) return of_few;
  // Frames of many iterations, as of tissue in contact, give it time sooner: a patient's median of
  // 22 iterations at 2,000 nodes with a lag of 3 becomes 15 with 2.
  return std::min(of_few, 1 + static_cast<int>(std::ceil(iterations / frame_iterations)));
}

void AsyncPreconditioner::advance() {
  if (!next_.valid() || --frames_left_ > 0) return;
  if (!superseded_) now_ = next_.get();
  next_ = {};
  superseded_ = false;
}

void AsyncPreconditioner::begin(const SpringPrismMesh& mesh, MeshLoads loads, Nodes x, int threads,
                                std::shared_ptr<const void> owner, int frame_iterations) {
  if (next_.valid()) return;
  frames_left_ = lag(*now_, frame_iterations);
  iterations_ = 0;
  next_ = std::async(threads > 1 ? std::launch::async : std::launch::deferred,
                     [like = now_, &mesh, loads = std::move(loads), x = std::move(x), threads,
                      owner = std::move(owner)]() -> std::shared_ptr<const HessianFactor> {
                       auto made = std::make_shared<HessianFactor>(like->anew(mesh, loads, x));
                       made->set_threads(threads);
                       return made;
                     })
              .share();
}

}  // namespace condyle
