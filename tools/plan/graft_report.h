#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "sim/operation/operation.h"

namespace condyle {

/// Adds `resections` and `grafts` to a report: pieces with lengths and saw cuts, faces with contact
/// and gaps, overlaps, warnings, insertion path.
void add_graft_report(nlohmann::ordered_json& report, const Plan& plan, const Operated& operated);

/// The same for people; empty without resections and grafts.
std::string graft_report_text(const Plan& plan, const Operated& operated);

/// One graft alone. Empty without it.
std::string graft_report_text(const Plan& plan, const Operated& operated, const std::string& name);

}  // namespace condyle
