#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace condyle {

inline nlohmann::ordered_json list(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace condyle
