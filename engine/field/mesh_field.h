#pragma once

#include "engine/field/sampled_field.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Signed distances of a closed surface at evenly spaced samples, negative inside: exact up to
/// `band_mm`, and that value with the right sign beyond. The inside is where the surface winds
/// about a sample, so shells that overlap count as their union; there, the distance is that of the
/// nearest shell. Edges of the mesh must be balanced (see Topology::closed). Bit-identical for any
/// number of threads.
SampledField mesh_field(const TriMesh& mesh, const std::array<GridAxis, 3>& axes, double band_mm,
                        int threads = 1);

/// Trilinear value of an evenly spaced field: as its own operator, several times as fast.
double even_value(const SampledField& field, const Eigen::Vector3d& p);

enum class Sweep { up, down };

/// The field of a solid that was moved along z, out of the grid: the least value below each sample
/// (up) or above it (down).
void sweep(SampledField& field, Sweep direction, int threads = 1);

/// Removes what is thinner than about twice `radius_mm`: a sample stays where a ball of this radius
/// fits into the solid no farther than `tolerance_mm` away. Values of the field must be true depths
/// up to the radius.
void remove_thin(SampledField& field, double radius_mm, double tolerance_mm, int threads = 1);
/// The same for the samples of an evenly spaced field within a box alone.
void remove_thin_within(SampledField& field, const Box& box, double radius_mm, double tolerance_mm,
                        int threads = 1);

}  // namespace condyle
