#pragma once

#include <vector>

namespace condyle {

/// Path of both condyle centres in the sagittal plane, from the seated position.
struct CondylarPath {
  std::vector<double> forward_mm;   // toward -y, increasing, first value at most 0
  std::vector<double> inferior_mm;  // toward -z, one per entry
};

}  // namespace condyle
