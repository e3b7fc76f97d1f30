#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace condyle {

/// Named points of the patient at rest, in the cranium's frame, mm. Names are canonical:
/// lower case words joined by '_', e.g. upper_incisal_point, lower_incisal_point, left_condyle,
/// right_condyle, stomion, left_cheilion, right_cheilion, soft_pogonion, pogonion, pronasale,
/// labrale_superius, labrale_inferius, left_porion, right_porion, left_orbitale, right_orbitale.
struct Landmarks {
  std::map<std::string, Eigen::Vector3d> points;

  std::optional<Eigen::Vector3d> find(const std::string& name) const {
    const auto it = points.find(name);
    if (it == points.end()) return std::nullopt;
    return it->second;
  }
};

}  // namespace condyle
