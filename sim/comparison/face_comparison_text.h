#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "sim/comparison/face_comparison.h"

namespace condyle {

/// Table of the distances by region, with the registration above it.
std::string face_comparison_text(const FaceComparison& comparison);
/// The same; `registration` has the pose of the face after the operation in the prediction's frame.
nlohmann::ordered_json face_comparison_json(const FaceComparison& comparison);
/// One row per vertex of the predicted face: vertex, x_mm, y_mm, z_mm, region, distance_mm (empty
/// without a partner).
std::string face_comparison_csv(const FaceComparison& comparison, const TriMesh& predicted);

}  // namespace condyle
