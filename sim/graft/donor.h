#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/plan/graft_step.h"

namespace condyle {

/// Bone that a graft is cut from. Its axis begins at the origin along x; y is the side that faces
/// outward on the jaw, and z points up there.
struct Donor {
  std::string name = {};
  TriMesh mesh = {};                   // closed, manifold, mm
  double length_mm = 0;                // along the axis
  double bend_radius_mm = 0;           // of the axis, about the point (0, -radius, 0); 0: straight
  double height_mm = 0, width_mm = 0;  // of its section, along z and y
  double first_mm = 0, last_mm = 0;    // part of the axis that may be taken
  std::string kept = {};               // what the rest is for, for people

  /// A point of the axis, and its direction there.
  Eigen::Vector3d axis(double at_mm) const;
  Eigen::Vector3d direction(double at_mm) const;
  /// Place on the axis of the point nearest to p.
  double place(const Eigen::Vector3d& p) const;
};

/// "fibula", "iliac_block", "rib".
const std::vector<std::string>& donor_names();

/// Fibula: a triangular prism with rounded edges, 13 x 15 mm, 360 mm long, of which 70 mm at each
/// end stay for the joints. Iliac block: 45 x 25 x 12 mm, bent by a radius of 120 mm. Rib: 12 x 8
/// mm along an arc of 110 mm. All are solid: cortex and marrow are one.
/// Any other name is a file with a closed surface in millimetres; its longest principal axis
/// becomes x. throws: InputError for a file that cannot be read, is not closed, or has another
/// surface than the step's `donor_shape`.
Donor make_donor(const GraftStep& step);

/// The hash that GraftStep::donor_shape stores; empty for built-in donors. throws: InputError.
std::string donor_shape(const std::string& donor);

}  // namespace condyle
