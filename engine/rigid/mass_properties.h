#pragma once

#include <Eigen/Core>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Mass, centre of mass and inertia of a body, in body coordinates.
struct MassProperties {
  double mass_kg = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // centre of mass, mm
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre of mass, kg mm^2
};

/// Mass properties of the solid within a closed mesh whose triangles face outward, of uniform
/// density (bone: about 1.9e-6 kg/mm^3).
/// throws: InputError when the mesh encloses no volume or the density is not positive.
MassProperties mass_properties(const TriMesh& mesh, double density_kg_mm3);

/// Mass properties of two bodies fixed to each other, in common coordinates.
MassProperties joined(const MassProperties& a, const MassProperties& b);

/// Smallest principal moment of inertia, kg mm^2.
double min_moment(const MassProperties& mass);

}  // namespace condyle
