#pragma once

#include <vector>

#include "engine/field/recipe.h"
#include "sim/case/case.h"

namespace condyle {

/// One tooth of the left side; its right twin is the mirror image.
struct ToothSolid {
  int fdi = 0;        // 21..27 or 31..37
  int right_fdi = 0;  // 11..17 or 41..47
  FieldRecipe solid;  // x > 0 side only
  Eigen::AlignedBox3d box;
};

/// The built-in patient as a solid: signed distances in the cranium's frame, mm, at rest. All
/// recipes are symmetric in x; all but the teeth are defined on both sides.
struct PhantomSolid {
  FieldRecipe skull, mandible;
  FieldRecipe skin;          // everything inside the skin, eyeballs and mouth included
  FieldRecipe oral_cavity;   // between lips, cheeks and throat; contains teeth and tongue
  FieldRecipe nasal_cavity;  // air inside the bony nose, as cut from the skull
  FieldRecipe upper_gums, lower_gums, tongue;
  std::vector<ToothSolid> teeth;  // 14; lower ones carved to leave 0.10 mm to the upper ones

  /// Nearest tooth of the side x >= 0 and its mirror; negative inside a tooth.
  double upper_teeth(const Eigen::Vector3d& p) const;
  double lower_teeth(const Eigen::Vector3d& p) const;
};

PhantomSolid make_phantom_solid();

/// Ends and direction of one tooth at rest, mm.
struct ToothPoints {
  int fdi = 0;
  Eigen::Vector3d tip;   // middle of the edge, cusp, buccal or mesiobuccal cusp; on the surface
  Eigen::Vector3d apex;  // end of the root; on the surface
  Eigen::Vector3d axis;  // of crown and root, unit, towards the tip
};

/// Of all 28 teeth, by FDI number.
std::vector<ToothPoints> tooth_points(const PhantomSolid& solid);

/// Path of the condyle centres along the eminence.
CondylarPath phantom_condylar_path();

}  // namespace condyle
