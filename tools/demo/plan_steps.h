#pragma once

#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/plan/plan.h"

namespace condyle {

Plan begin_plan(const Case& patient, const std::string& name, const HeadReference& reference = {});

/// The plan with an osteotomy as placed from landmarks. throws: InputError as place_osteotomy().
Plan with_cut(const Case& patient, Plan plan, CutStep step);

/// The plan with a move in the words of `condyle plan move`.
Plan with_move(Plan plan, const std::string& segment, const std::vector<std::string>& words);

}  // namespace condyle
