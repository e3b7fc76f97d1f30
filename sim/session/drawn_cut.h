#pragma once

#include <string>

#include "sim/choice/plan_view.h"
#include "sim/operation/operation.h"

namespace condyle {

/// The cut step that a drawing asks for: one bent sheet, in the frame of the uncut rest. The
/// smaller piece becomes a segment; what is left stays with its body. `operated`: the patient on
/// whom it was drawn. throws: InputError for an unknown bone, fewer than two points, and a line
/// that runs along the direction or back on itself.
CutStep drawn_cut(const Operated& operated, const plan_edit::DrawCut& drawing);

/// The cut with another place of a point of its surfaces. throws: InputError without that point.
CutStep with_point(const Operated& operated, CutStep cut, const plan_edit::MovePoint& edit);

/// The points of a step's own surfaces, on the patient as shown. `body`: that is cut.
std::vector<PlanHandle> point_handles(const Operated& operated, const CutStep& cut);

}  // namespace condyle
