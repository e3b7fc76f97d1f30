#pragma once

#include <string>
#include <vector>

#include "engine/dicom/slice_header.h"

namespace condyle {

/// The slices of one stack: of one series, patient, kernel, frame of reference, size and
/// orientation.
struct SliceGroup {
  std::vector<SliceHeader> slices;    // from the lowest position along row x column
  std::vector<std::string> notes;     // what was left out or separated
  std::vector<std::string> problems;  // why it is no volume; files by their number in the series
};

/// Divides slices into groups, in the order of their first file. Doubled files are dropped, slices
/// at one position are separated where the header tells them apart.
std::vector<SliceGroup> group_slices(std::vector<SliceHeader> slices);

/// The distance of the slice's position along a direction; 0 where it has none.
double height_along(const SliceHeader& slice, const Eigen::Vector3d& normal);

}  // namespace condyle
