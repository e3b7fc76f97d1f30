#pragma once

#include <vector>

#include "sim/report/motion_findings.h"

namespace condyle {

/// Measures of the face under its muscles, in its own state and against rest; with published ranges
/// for a full smile of both sides. All are inputs: the muscles' forces and attachments were chosen
/// on the built-in patient for such a smile. Empty without soft tissue or landmarks of the mouth.
std::vector<Finding> expression_findings(const Scene& scene, const TissueState& tissue);

}  // namespace condyle
