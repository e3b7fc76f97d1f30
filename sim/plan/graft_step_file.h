#pragma once

#include <nlohmann/json.hpp>

#include "sim/case/json_file.h"
#include "sim/plan/graft_step.h"

namespace condyle {

// Steps of a plan's file. Reading throws InputError naming file and item.

nlohmann::ordered_json graft_step_json(const ResectStep& step);
nlohmann::ordered_json graft_step_json(const GraftStep& step);
ResectStep resect_step_in(const JsonItem& item);
GraftStep graft_step_in(const JsonItem& item);

}  // namespace condyle
