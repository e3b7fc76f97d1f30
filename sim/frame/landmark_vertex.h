#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string_view>

#include "sim/frame/part.h"

namespace condyle {

/// The vertex of a patient's surfaces that carries a point.
struct LandmarkVertex {
  std::size_t part = 0;
  int vertex = 0;
};

/// The vertex nearest to a landmark; condyles belong to the mandible wherever they lie. Reads every
/// vertex: some milliseconds for a whole head.
LandmarkVertex landmark_vertex(std::string_view landmark, const Eigen::Vector3d& at_rest,
                               std::span<const Part> parts);

}  // namespace condyle
