#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/operation/segment_overlaps.h"

namespace condyle {

/// Measurements on an operated patient that take time.
struct OperationFindings {
  std::vector<SegmentOverlap> overlaps = {};                    // at the planned positions
  std::map<std::string, std::vector<std::string>> grafts = {};  // sentences, by name
};

/// Those on grafts alone, within a fraction of a second.
OperationFindings find_in_grafts(const Operated& operated);
OperationFindings find_in_operation(const Operated& operated);

}  // namespace condyle
