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
  std::string limit;  // why the model may leave the range; empty inside it

  double ratio() const { return soft_mm / hard_mm; }
};

/// Rows for the pairs whose bone moves at least 0.5 mm forward or back.
std::vector<SoftRatio> soft_ratios(const Prediction& prediction, const ClinicalFrame& frame);

/// "0.6 to 0.8", "0.24" for a mean alone, empty where none is known.
std::string published_range(const SoftRatio& row);
/// One sentence for each ratio outside its published range, or farther than 0.1 from a mean, with
/// the limit of the model that explains it.
std::vector<std::string> ratios_outside(const std::vector<SoftRatio>& ratios);

/// Displacements of the soft landmarks in words, then the ratios: aligned text.
std::string prediction_text(const Prediction& prediction, const ClinicalFrame& frame);
nlohmann::ordered_json prediction_json(const Prediction& prediction, const ClinicalFrame& frame);

}  // namespace condyle
