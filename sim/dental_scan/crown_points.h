#pragma once

#include <Eigen/Core>
#include <array>

#include "engine/mesh/tri_mesh.h"
#include "engine/registration/best_fit.h"

namespace condyle {

/// Points on the occlusal 5 mm of an arch, with the direction in which its teeth bite.
struct CrownPoints {
  OrientedPoints points;
  Eigen::Vector3d bite = Eigen::Vector3d::Zero();    // unit
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the points
};

/// About `count` points of the surface within 5 mm of the crowns' local height; the floor of the
/// mouth, the palate and most of the gum lie deeper.
CrownPoints crown_points(const TriMesh& mesh, const Eigen::Vector3d& bite, int count);

/// Unit normal of the plane in which the surface spreads least.
Eigen::Vector3d flat_normal(const TriMesh& mesh);

/// The mirror image in x.
CrownPoints mirrored(CrownPoints crowns);

}  // namespace condyle
