#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/volume/volume.h"

namespace condyle {

enum class SliceSide { axial, coronal, sagittal };

/// A slice of a volume as radiologists look at it: axial and coronal ones with the patient's left
/// at the right, sagittal ones with the face at the left; back or feet down.
struct SliceValues {
  int width = 0, height = 0;
  std::vector<std::int16_t> values = {};             // HU, rows from the top
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();  // centre of the first value, mm
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();  // to the next value of a row, mm
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();   // to the next row, mm
  Eigen::Vector3d step = Eigen::Vector3d::UnitZ();   // to the next slice, mm, S, P or L
  int number = 0, count = 0;                         // of the slice, and of all
};

/// The slice along a plane of the lattice that is nearest to a point. Of turned lattices that
/// plane is taken which is nearest to the anatomical one.
SliceValues slice_through(const Volume& volume, SliceSide side, const Eigen::Vector3d& point);

/// The centre of a volume, mm.
Eigen::Vector3d centre_of(const Volume& volume);

}  // namespace condyle
