#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/plan/clinical_frame.h"
#include "sim/prediction/prediction.h"

namespace condyle {

/// How far a point of the face moves with the bone below it, along the bone's movement.
struct SoftRatio {
  std::string soft, hard;           // landmarks
  double hard_mm = 0, soft_mm = 0;  // forward; negative: back
  // Range of the literature for this direction, where one is known.
  std::optional<double> low, high;
  std::string source;

  double ratio() const { return soft_mm / hard_mm; }
};

/// Rows for the pairs whose bone moves at least 0.5 mm forward or back.
std::vector<SoftRatio> soft_ratios(const Prediction& prediction, const ClinicalFrame& frame);

/// Displacements of the soft landmarks in words, then the ratios: aligned text.
std::string prediction_text(const Prediction& prediction, const ClinicalFrame& frame);
nlohmann::ordered_json prediction_json(const Prediction& prediction, const ClinicalFrame& frame);

}  // namespace condyle
