#pragma once

#include "engine/field/recipe.h"

namespace condyle {

// Left eyeball.
inline const Eigen::Vector3d eye_center(32, -73.5, 14.5);
constexpr double eye_radius = 12;

/// Opening between the lids, a prism along y: negative inside.
Primitive lid_opening();

/// Head and neck inside the skin; `Lips::closed` has a shallow groove between the lips,
/// `Lips::none` leaves the groove away for the mouth that is cut open later.
enum class Lips { closed, none };
FieldRecipe skin_recipe(Lips lips);

/// Radius of the face about a vertical axis by height and azimuth: the head without nose, lips,
/// eyes and ears.
Primitive face_base();
void add_ear(FieldRecipe& head);

/// Mouth. Height of the surface on which the lips meet; it rises inward, so that no straight line
/// of sight passes between them.
double lip_line(double x, double y);
constexpr double mouth_corner_x = 24.5;  // mm
/// Space behind the lips and cheeks, around both arches.
Primitive oral_space();

FieldRecipe upper_gums_recipe();
FieldRecipe lower_gums_recipe();
FieldRecipe tongue_recipe();

}  // namespace condyle
