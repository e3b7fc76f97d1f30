#pragma once

#include <string>
#include <vector>

#include "sim/operation/operation.h"

namespace condyle {

/// The segments that an osteotomy makes on a patient, by the osteotomy's own names.
/// throws: InputError as place_osteotomy().
std::vector<std::string> segment_names(const Case& patient, CutStep step);

/// The plan with another cut in the place of a step. Where it makes other segments than before, and
/// `keeps_names` is false, it takes the osteotomy's own names for them. `uncut`: the case of the
/// plan. throws: InputError as apply_plan() and with_recut().
Plan with_changed_cut(const Case& uncut, const Plan& plan, int id, CutStep cut,
                      bool keeps_names = false);

/// The dangers of a cut or trim step below the least margins that the step does not ask for, in one
/// sentence; empty without one.
std::string dangers_below_margins(const Operated& operated, int step);

}  // namespace condyle
