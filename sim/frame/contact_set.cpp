#include "sim/frame/contact_set.h"

#include <algorithm>
#include <limits>

namespace condyle {

double ContactSet::min_clearance_mm() const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& pair : pairs) least = std::min(least, pair.touching ? 0.0 : pair.distance_mm);
  return least;
}

double ContactSet::max_penetration_mm() const {
  double most = 0;
  for (const auto& pair : pairs) most = std::max(most, pair.depth_mm - pair.rest_depth_mm);
  return most;
}

}  // namespace condyle
