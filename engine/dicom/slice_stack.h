#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/dicom/slice_header.h"

namespace condyle {

/// How the slices of a group lie to each other.
struct StackGeometry {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // row x column
  std::vector<double> height_mm;          // of each slice along the normal, above the first
  std::vector<Eigen::Vector2d> shift_mm;  // of each along rows and columns, against the first
  double step_mm = 0;                     // median distance along the normal; 0: one position
  double tilt_degrees = 0;                // of the gantry
  bool sheared = false;                   // the slices must be shifted back
  std::string uneven;                     // where slices are missing or uneven; empty: nowhere
};

/// Compares the positions of slices that are sorted by height. The step is even where each differs
/// from the median by at most 1 %. The stack is sheared where its tilt is above 0.5 degrees or a
/// slice is shifted by more than half a pixel.
StackGeometry stack_geometry(const std::vector<SliceHeader>& slices);

}  // namespace condyle
