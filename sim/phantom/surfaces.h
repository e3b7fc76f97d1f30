#pragma once

#include <array>
#include <functional>

#include "engine/core/progress.h"
#include "engine/field/sampled_field.h"
#include "sim/phantom/phantom_solid.h"

namespace condyle {

// The parts of the built-in patient as triangles. mm, at rest.

/// A solid that is symmetric in x, sampled on a grid of the half x >= 0, as a closed, exactly
/// symmetric surface of about the given number of triangles; `importance` as in DecimationOptions.
TriMesh symmetric_surface(const FieldRecipe& solid, const std::array<GridAxis, 3>& half_grid,
                          int triangles,
                          const std::function<double(const Eigen::Vector3d&)>& importance = {});

/// All teeth of one arch in FDI order; closed pieces, one run of triangles each.
Part teeth_part(const PhantomSolid& solid, bool upper);

/// Skin with a mouth that can open: upper and lower lip meet only at the corners, and end 7 mm
/// behind the lips with an open border. With colours.
TriMesh face_surface();

/// Natural asymmetry of the skin, which is symmetric as a solid: the nose leans to the left and the
/// chin to the right, the left brow is higher and the left ear lower. Lips and lids, which must
/// fit, are unchanged. mm
Eigen::Vector3d uneven_face(const Eigen::Vector3d& p);

/// Both eyeballs and the lashes before them, closed, with colours.
TriMesh eyes_surface();
/// Adds lashes along both lids to the left eye, each a closed strand.
void add_lashes(TriMesh& eye);

/// Named points of the head; those on a surface are moved onto it.
Landmarks phantom_landmarks(const PhantomSolid& solid);

/// What a landmark of the built-in patient moves with: skull, mandible or face.
Role landmark_role(const std::string& name);

/// Mandibular canals of both sides, from the lingula to the mental foramen.
std::vector<Canal> phantom_canals(const Landmarks& landmarks);

/// build_phantom on a number of threads; bit-identical for any number.
Case build_phantom_on(int threads, const Progress& progress = {});

/// sRGB, 0 to 1, of the skin at a point of the face.
Eigen::Vector3f skin_color(const Eigen::Vector3d& p);

}  // namespace condyle
