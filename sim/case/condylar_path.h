#pragma once

#include <vector>

namespace condyle {

/// Path of both condyle centres in the sagittal plane, from the seated position.
struct CondylarPath {
  std::vector<double> forward_mm;  // toward -y, increasing, starts at or below 0
  std::vector<double> drop_mm;     // toward -z, one per entry
};

}  // namespace condyle
