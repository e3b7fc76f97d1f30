#pragma once

#include <nlohmann/json.hpp>

#include "tools/bench/baseline/tissue_target.h"

namespace condyle {

/// A row for each tolerance from 1 mm to 1e-6 mm: time of a cold solve by our method, the
/// factor at rest apart, and what is left of error (worst node, relative energy).
nlohmann::ordered_json tolerance_rows(const TissueTarget& target, int repeats);

/// One prediction from nothing, in a tissue of about that many nodes: springs and prisms, factor
/// and solve, each with its time. The error is the distance to a solution that is computed from
/// there to a tenth of the tolerance.
nlohmann::ordered_json static_prediction(int nodes, int threads);

}  // namespace condyle
