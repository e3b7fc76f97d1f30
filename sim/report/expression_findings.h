#pragma once

#include <vector>

#include "sim/report/motion_findings.h"
#include "sim/report/smile_measures.h"

namespace condyle {

/// The face under its muscles.
struct ExpressionMeasures {
  // With published ranges for a full smile of both sides. Those of the corners and lips are inputs:
  // forces and attachments of the muscles were chosen on the built-in patient for such a smile.
  std::vector<Finding> findings = {};
  SmileMeasures at_rest = {}, now = {};  // what the lips show of the upper teeth
};

/// Of a state of the tissue, against rest. Empty without soft tissue, excitation or landmarks of
/// the mouth.
ExpressionMeasures expression_measures(const Scene& scene, const TissueState& tissue);

}  // namespace condyle
