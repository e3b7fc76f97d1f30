#include "engine/tissue/async_preconditioner.h"

#include <algorithm>
#include <cmath>

namespace condyle {

int AsyncPreconditioner::lag(const HessianFactor& factor) {
  // Frames of a steady motion take 1 iteration at 2,000 nodes, 3 at 10,000 and 10 at 50,000, the
  // younger their factor the fewer: beyond 5 frames more is lost by age than by waiting.
  const double iterations = factor.iterations_per_factorization();
  return std::clamp(static_cast<int>(std::lround((iterations - 8) / 4)), 1, 5);
}

void AsyncPreconditioner::advance() {
  if (!next_.valid() || --frames_left_ > 0) return;
  if (!superseded_) now_ = next_.get();
  next_ = {};
  superseded_ = false;
}

void AsyncPreconditioner::begin(const SpringPrismMesh& mesh, MeshLoads loads, Nodes x, int threads,
                                std::shared_ptr<const void> owner) {
  if (next_.valid()) return;
  frames_left_ = lag(*now_);
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
