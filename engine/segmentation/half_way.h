#pragma once

#include "engine/core/progress.h"
#include "engine/mesh/tri_mesh.h"
#include "engine/volume/volume.h"

namespace condyle {

struct HalfWayOptions {
  double threshold_hu = 300;  // at which the surface was found
  double rise_hu = 150;       // outside, a rise by so much ends the search for the lowest value
  double drop_hu = 60;        // inside, a drop by so much and a third of the height ends it
  int threads = 1;
};

/// Moves each vertex along its normal to where the scan is half way between the plateau inside and
/// the lowest value outside, at most 1.5 voxels; a fixed threshold is biased outward. Moves are
/// averaged over neighbours; vertices without such a place follow theirs. Returns the fraction of
/// vertices that had one. Bit-identical for any number of threads.
double move_to_half_way(TriMesh& mesh, const Volume& volume, const HalfWayOptions& options,
                        const Progress& progress = {});

}  // namespace condyle
