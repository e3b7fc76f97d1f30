#pragma once

#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "engine/segmentation/scan_surfaces.h"

namespace condyle {

/// The zero surface of values in a box of voxels, negative inside; positive at the border of the
/// box. Closed and oriented outward, mm. Pieces of less than `least_mm3` are dropped, and so are
/// cavities. Only for this module.
TriMesh lattice_surface(const Volume& volume, const VoxelBox& box, std::vector<float> values,
                        double least_mm3);

/// The flaw that is removed last and therefore stays only where it cannot be removed: triangles
/// that pass through others, where the surface is inside out, or ones folded onto their neighbours.
enum class Flaws { crossings, folds };

/// Decimates the surface, without the worse flaws for its use, and measures the error.
void decimate_surface(ScanSurface& surface, Flaws worse, const SurfaceOptions& options,
                      const Progress& progress);

}  // namespace condyle
