#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "sim/operation/operation.h"

namespace condyle {

/// What a plan does to its patient, for programs: `segments` (name, parent, volume_mm3, closed),
/// `remaining`, `volume_error_percent`, `cuts`, `trims`, `resections`, `grafts`, `overlaps`,
/// `movements`, `cephalometry`, `notes`, `problems`.
nlohmann::ordered_json plan_report_json(const Plan& plan, const Operated& operated);

/// The same for people: steps, cuts, table of displacements, cephalometry.
std::string plan_report_text(const Plan& plan, const Operated& operated);

/// The cut or trim of one step alone; empty without.
std::string cut_report_text(const Operated& operated, int step);

}  // namespace condyle
