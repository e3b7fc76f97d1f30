#pragma once

#include <string>

#include "engine/volume/volume.h"

namespace condyle {

/// Hounsfield units that a scan itself shows for its tissues.
struct TissueLevels {
  double air = -1000;      // mode of what is darker than fat
  double soft = 50;        // mode between -50 and 150
  double cortical = 1300;  // mean above 700

  /// Threshold at which thin bone is kept: the surface is moved to the half-way level later.
  double low_bone() const { return soft + 0.2 * (cortical - soft); }
  /// Half way between air and soft tissue.
  double skin() const { return 0.5 * (air + soft); }
};

/// The levels of a scan of a head, from its histogram. `name`: the scan in messages.
/// throws: InputError for a volume without soft tissue (only air) and one without bone.
TissueLevels tissue_levels(const Volume& volume, const std::string& name);

}  // namespace condyle
