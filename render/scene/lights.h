#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "render/camera/camera.h"
#include "render/gl/gl_objects.h"

namespace condyle {

/// Studio light fixed to the camera, so that every view is well lit: a warm key from above the
/// viewer's left shoulder, a cool fill, a rim from behind, and a sky over a dim floor. Directions
/// are unit, towards the light; colours linear.
struct Lights {
  Eigen::Vector3f key_direction, fill_direction, rim_direction, sky_direction;
  Eigen::Vector3f key_color, fill_color, rim_color, sky_color, ground_color, front_color;

  /// Sets them in the program in use.
  void set_in(GlProgram& program) const;
};

Lights lights_for(const Camera& camera);

/// World to the unit cube of the key light's depth map, fitted around a box.
Eigen::Matrix4f shadow_matrix(const Lights& lights, const Eigen::AlignedBox3f& box);

}  // namespace condyle
