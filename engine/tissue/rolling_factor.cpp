#include "engine/tissue/rolling_factor.h"

namespace condyle {

void RollingFactor::advance() {
  if (!next_.valid() || --frames_left_ > 0) return;
  now_ = next_.get();
  next_ = {};
}

void RollingFactor::begin(const SpringPrismNet& net, NetLoads loads, Nodes x, int threads,
                          std::shared_ptr<const void> owner) {
  if (next_.valid()) return;
  frames_left_ = lag;
  served_ = 0;
  next_ = std::async(threads > 1 ? std::launch::async : std::launch::deferred,
                     [like = now_, &net, loads = std::move(loads), x = std::move(x), threads,
                      owner = std::move(owner)]() -> std::shared_ptr<const HessianFactor> {
                       auto made = std::make_shared<HessianFactor>(like->anew(net, loads, x));
                       made->set_threads(threads);
                       return made;
                     })
              .share();
}

}  // namespace condyle
