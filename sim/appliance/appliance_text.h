#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim/appliance/guide.h"
#include "sim/appliance/splint.h"

namespace condyle {

/// What was made and measured, as lines for people.
std::string splint_text(const Splint& splint, const SplintSettings& settings);
/// The same as numbers: mm, degrees, mm^2, mm^3; directions are unit vectors of the cranium.
nlohmann::ordered_json splint_json(const Splint& splint, const SplintSettings& settings);

std::string guide_text(const Guide& guide, const GuideSettings& settings);
nlohmann::ordered_json guide_json(const Guide& guide, const GuideSettings& settings);

/// Lines and values that splints and guides share.
std::string measure_text(const ApplianceMeasure& measure, double grip_mm);
nlohmann::ordered_json measure_json(const ApplianceMeasure& measure);

/// "0.3 left, 0.1 back, 0.9 up" of a unit vector in the cranium's axes.
std::string direction_text(const Eigen::Vector3d& direction);

}  // namespace condyle
