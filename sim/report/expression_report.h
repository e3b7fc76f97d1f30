#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim/report/expression_findings.h"

namespace condyle {

/// The smile line and the teeth one by one, for report.json, where the findings have the rest.
/// `before`: of the same expression before an operation, with all of its findings; null: none.
nlohmann::ordered_json expression_json(const ExpressionMeasures& measures,
                                       const ExpressionMeasures* before = nullptr);

/// A row per measure: quantity, unit, value, low, high, published, and with `before` that value,
/// too. Cells of unknown values are empty.
std::string expression_csv(const ExpressionMeasures& measures,
                           const ExpressionMeasures* before = nullptr);

/// The same as an aligned table for the terminal, without the teeth one by one.
std::string expression_text(const ExpressionMeasures& measures,
                            const ExpressionMeasures* before = nullptr);

}  // namespace condyle
