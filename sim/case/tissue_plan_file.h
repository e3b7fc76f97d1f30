#pragma once

#include <nlohmann/json.hpp>

#include "sim/case/json_file.h"
#include "sim/case/tissue_plan.h"

namespace condyle {

/// The object "tissue" of a case.json. throws: InputError naming file, item and value.
TissuePlan load_tissue_plan(const JsonItem& item);

/// The same object; empty for an empty plan.
nlohmann::ordered_json tissue_plan_json(const TissuePlan& plan);

}  // namespace condyle
