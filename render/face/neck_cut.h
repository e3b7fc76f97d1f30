#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace condyle {

/// Height of the flat surface that closes the neck of a face below, mm, LPS. None where the face is
/// open there, or ends so close to the chin that no neck remains. `rest`: vertices; `rim`: of
/// those, around the mouth.
std::optional<float> find_neck_cut(std::span<const Eigen::Vector3f> rest,
                                   std::span<const Eigen::Vector3i> triangles,
                                   std::span<const int> rim);

}  // namespace condyle
