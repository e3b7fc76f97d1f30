#pragma once

#include "engine/field/sampled_field.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Triangles of the surface where the sampled field is zero, outside = positive. Closed and
/// manifold wherever it does not run into the border of the grid. Vertices on grid edges that lie
/// in the border planes stay exactly in them, so that halves can be mirrored.
TriMesh isosurface(const SampledField& field);

/// A half mesh (x >= 0) joined with its mirror image; vertices at exactly x = 0 are shared.
TriMesh with_mirror_image(const TriMesh& half);

/// The mirror image alone (x negated, triangles flipped).
TriMesh mirror_image(const TriMesh& mesh);

/// The component with the most triangles; the others and loose vertices are dropped.
TriMesh largest_piece(const TriMesh& mesh);

/// The part of a surface where the value at the vertices is negative; triangles across the border
/// are split along it. One value per vertex. Isolated vertices are dropped.
TriMesh clipped(const TriMesh& mesh, const std::vector<double>& values);

}  // namespace condyle
