#pragma once

#include <Eigen/Core>

#include "sim/frame/part.h"

namespace condyle {

/// Appearance of the surfaces of a role.
struct Material {
  Eigen::Vector3f color;    // sRGB, where the mesh has none of its own
  float roughness;          // 0 mirror to 1 chalk
  float reflectance;        // reflected fraction at normal incidence
  float wrap;               // how far light wraps around the terminator, 0 to 1
  Eigen::Vector3f scatter;  // colour of light scattered below the surface
  float coat;               // strength of a second, sharp reflection: enamel, wet surfaces
};

Material material_of(Role role);

/// sRGB, of a cut face.
Eigen::Vector3f cut_color_of(Role role);

}  // namespace condyle
