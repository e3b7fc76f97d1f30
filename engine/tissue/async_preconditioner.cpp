#include "engine/tissue/async_preconditioner.h"

namespace condyle {

void AsyncPreconditioner::advance() {
  if (!next_.valid() || --frames_left_ > 0) return;
  now_ = next_.get();
  next_ = {};
}

void AsyncPreconditioner::begin(const SpringPrismMesh& mesh, MeshLoads loads, Nodes x, int threads,
                                std::shared_ptr<const void> owner) {
  if (next_.valid()) return;
  frames_left_ = lag;
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
