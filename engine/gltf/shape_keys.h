#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle {

/// Frames of a changing shape that, joined by straight lines in time, reproduce all frames.
struct ShapeKeys {
  std::vector<std::size_t> frames;  // increasing, the first and the last included
  double error_mm = 0;              // largest distance of a vertex from its place in any frame
};

/// The fewest keys such that each starts the longest interval with an error of at most `error_mm`.
/// `shapes`: vertices of each frame, mm. A shape that does not change has one key. Deterministic.
ShapeKeys choose_shape_keys(const std::vector<std::vector<Eigen::Vector3f>>& shapes,
                            const std::vector<double>& times_s, double error_mm);

}  // namespace condyle
