#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/landmarks.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {

/// Published values of European adults: for comparison, not a target.
struct CephalometricNorm {
  double mean = 0;
  double sd = 0;          // 0: none is known; of a range: half of its width
  bool is_range = false;  // mean - sd to mean + sd
  std::string source = {};
};

/// A measure on the midsagittal projection, before and after. Absent where landmarks are missing.
struct CephalometricMeasure {
  std::string name;  // "SNA", "overjet"
  std::string unit;  // "deg", "mm", "%"
  std::optional<double> before, after;
  CephalometricNorm norm;
  std::vector<std::string> missing;  // landmarks that the case lacks

  std::optional<double> change() const {
    if (!before || !after) return std::nullopt;
    return *after - *before;
  }
};

/// All measures in a fixed order. Paired points are averaged first and need both sides. `after` has
/// the moved landmarks, see moved_landmarks(); `frame` is that of the patient before the operation.
/// Inclinations of incisors need the landmarks upper_left_central_incisor_apex etc.; the nasolabial
/// angle needs columella. Angles to the Frankfort plane use porion and orbitale, also in natural
/// head position.
std::vector<CephalometricMeasure> cephalometry(const ClinicalFrame& frame, const Landmarks& before,
                                               const Landmarks& after);

/// "82 ± 3.5", "0 to 1", "45".
std::string norm_text(const CephalometricNorm& norm);

/// Aligned text: measure, before, after, change, norm and its source; then what is missing.
std::string cephalometry_text(const std::vector<CephalometricMeasure>& measures);
nlohmann::ordered_json cephalometry_json(const std::vector<CephalometricMeasure>& measures);

}  // namespace condyle
