#pragma once

#include <Eigen/Core>

#include "sim/frame/part.h"

namespace condyle {

/// How a surface of a role looks.
struct Material {
  Eigen::Vector3f color;    // sRGB, where the mesh has none of its own
  float roughness;          // 0 mirror to 1 chalk
  float reflectance;        // mirrored share, looking straight at it
  float wrap;               // how far light creeps round the edge of the lit side, 0 to 1
  Eigen::Vector3f scatter;  // colour of light that passes through a little
  float coat;               // strength of a second, sharp reflection: enamel, wet surfaces
};

Material material_of(Role role);

/// sRGB, of a face cut through it.
Eigen::Vector3f cut_color_of(Role role);

}  // namespace condyle
