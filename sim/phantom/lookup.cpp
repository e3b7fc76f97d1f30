#include "sim/phantom/lookup.h"

#include "engine/math/pchip.h"

namespace condyle {

Lookup::Lookup(std::span<const double> x, std::span<const double> y)
    : low_(x.front()), values_(601) {
  const Pchip curve(x, y);
  const double step = (x.back() - x.front()) / static_cast<double>(values_.size() - 1);
  scale_ = 1 / step;
  for (std::size_t i = 0; i < values_.size(); ++i)
    values_[i] = curve(low_ + step * static_cast<double>(i));
}

}  // namespace condyle
