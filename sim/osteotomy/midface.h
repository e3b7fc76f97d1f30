#pragma once

#include <optional>
#include <string>

#include "sim/osteotomy/surgical_anatomy.h"

namespace condyle {

/// What Le Fort osteotomies are placed by: points of the left side stand for both.
struct Midface {
  double canine_y = 0, canine_z = 0;  // highest point of the canine's root
  double molar_y = 0, molar_z = 0;    // of the molars' roots
  double widest_root = 0;             // of the molars: distance from the midsagittal plane
  double floor_z = 0;                 // of the nose
  double front_y = 0, back_y = 0;     // anterior nasal spine, posterior nasal spine
  double incisal_z = 0;
  std::optional<Eigen::Vector3d> crest;  // zygomaxillare
};

/// From teeth and landmarks; adds notes of what was estimated. throws: InputError without the upper
/// incisal point.
Midface find_midface(SurgicalAnatomy& jaw);

/// The middle of a paired landmark's left point and the mirrored right one. throws: InputError
/// naming a missing one.
Eigen::Vector3d paired_point(const SurgicalAnatomy& skull, const std::string& name);

}  // namespace condyle
