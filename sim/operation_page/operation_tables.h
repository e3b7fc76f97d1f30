#pragma once

#include <string>
#include <vector>

#include "sim/operation/segment_overlaps.h"
#include "sim/plan/cephalometry.h"
#include "sim/prediction/prediction.h"
#include "sim/prediction/soft_ratios.h"
#include "sim/report/operation_comparison.h"

namespace condyle {

/// A table of a page: texts for people, not yet escaped.
struct PageTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> marked = {};  // rows that need attention
};

/// As HTML; rows that need attention have the class `bad`. Empty without rows.
std::string table_html(const PageTable& table);

PageTable bones_table(const Operated& operated);
PageTable movements_table(const MovementTable& movements);
/// Rotations of the segments that turn.
PageTable rotations_table(const MovementTable& movements);
/// Midlines and cants before and after.
PageTable midlines_table(const MovementTable& movements);
/// `has_soft`: the measures of the profile are those of a predicted face; else they are left out.
/// Values after the operation that lie outside their norm are marked with a star.
/// What the marks of cephalometry_table() mean, and where its norms come from.
std::string cephalometry_legend(const Operated& operated);
PageTable cephalometry_table(const std::vector<CephalometricMeasure>& measures, bool has_soft);
PageTable overlaps_table(const std::vector<SegmentOverlap>& overlaps);
/// Danger zones near the cuts and trims, nearest first in each.
PageTable dangers_table(const Operated& operated);
PageTable ratio_table(const std::vector<SoftRatio>& ratios);
/// Displacements of the landmarks of the predicted face.
PageTable soft_points_table(const Prediction& prediction, const ClinicalFrame& frame);
PageTable range_of_motion_table(const OperationComparison& comparison);
PageTable clearances_table(const OperationComparison& comparison);

}  // namespace condyle
