#pragma once

#include "sim/phantom/solid.h"

namespace condyle {

// The parts of the built-in patient as triangles. mm, at rest.

/// A solid that is symmetric in x, as a closed, exactly symmetric surface.
struct BodySurface {
  double spacing = 0.65;                                          // mm, of the samples
  int triangles = 50000;                                          // about, after decimation
  std::function<double(const Eigen::Vector3d&)> importance = {};  // see DecimationOptions
};
TriMesh symmetric_surface(const FieldRecipe& solid, const Eigen::AlignedBox3d& half_box,
                          const BodySurface& options);

/// All teeth of one arch in FDI order; closed pieces, one run of triangles each.
Part teeth_part(const PhantomSolid& solid, bool upper);

/// Skin with a mouth that can open: upper and lower lip meet only at the corners, and end 7 mm
/// behind the lips with an open border. With colours.
TriMesh face_surface();

/// Both eyeballs, closed, with colours.
TriMesh eyes_surface();

/// Named points of the head; those on a surface are moved onto it.
Landmarks phantom_landmarks(const PhantomSolid& solid);

/// sRGB, 0 to 1, of the skin at a point of the face.
Eigen::Vector3f skin_color(const Eigen::Vector3d& p);

}  // namespace condyle
