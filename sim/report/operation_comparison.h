#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/report/clearance.h"

namespace condyle {

/// A measure of the same motion before and after an operation. Absent where it is not known.
struct ComparedMeasure {
  std::string name, unit;  // as in report.json: "opening", "mm"
  std::optional<double> before, after;
};

/// A pair of parts in the same motion before and after an operation. Absent where a side has no
/// such pair, as that of two segments before the cut.
struct ComparedPair {
  std::string a, b;
  struct Clearance {
    double least_mm = 0;    // negative: depth of the overlap
    double at_rest_mm = 0;  // the same in the first frame
    bool violated = false;
  };
  std::optional<Clearance> before, after;
};

/// How a patient's jaw moves before and after an operation: range of motion, and clearance or
/// overlap of bones and teeth.
struct OperationComparison {
  std::vector<ComparedMeasure> measures;
  std::vector<ComparedPair> pairs;  // those of the operated patient first

  nlohmann::ordered_json json() const;
  std::string text() const;  // two aligned tables
  std::string html() const;  // the same for a page, with headings
};

/// Moves the patient before and after by the same motion, made anew for each. The checks are of
/// these motions.
OperationComparison compare_operation(const Scene& before, const Motion& motion_before,
                                      const ClearanceCheck& check_before, const Scene& after,
                                      const Motion& motion_after,
                                      const ClearanceCheck& check_after);

}  // namespace condyle
