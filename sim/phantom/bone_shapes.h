#pragma once

#include "engine/field/recipe.h"
#include "sim/case/case.h"

namespace condyle {

// Joint: the left condyle at rest.
inline const Eigen::Vector3d condyle_center(50.5, -13, -7.5);
Primitive condyle_shape();

/// The space of the moving condyle, cut from the temporal bone: the condyle along its path, grown
/// by the thickness of disc and cartilage.
Primitive fossa_cut();

/// Brain case without its cavity, moved out by `outward` mm.
Primitive vault_shape(double outward);

FieldRecipe skull_recipe();
FieldRecipe mandible_recipe();
FieldRecipe nasal_cavity_recipe();

}  // namespace condyle
