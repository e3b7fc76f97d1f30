#include "engine/segmentation/lattice_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "engine/core/parallel.h"
#include "engine/field/isosurface.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/simplify.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

GridAxis steps(int count) {
  GridAxis axis(static_cast<std::size_t>(count));
  std::iota(axis.begin(), axis.end(), 0.0);
  return axis;
}

/// Drops pieces of less volume; cavities have a negative one.
void drop_small_pieces(TriMesh& mesh, double least_mm3) {
  const Components pieces = find_components(mesh);
  std::vector<double> volume(static_cast<std::size_t>(pieces.count), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](int c) {
      return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][c])];
    };
    volume[static_cast<std::size_t>(pieces.of_triangle[t])] +=
        corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (volume[static_cast<std::size_t>(pieces.of_triangle[t])] >= least_mm3)
      mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
  drop_unreferenced(mesh);
}

}  // namespace

TriMesh lattice_surface(const Volume& volume, const VoxelBox& box, std::vector<float> values,
                        double least_mm3) {
  // The last axis of a field is fastest, that of a volume is slowest: the axes change places.
  TriMesh mesh =
      isosurface({{steps(box.size[2]), steps(box.size[1]), steps(box.size[0])}, std::move(values)});
  for (Vector3d& p : mesh.vertices) p = box.position(volume, p.z(), p.y(), p.x());
  if (volume.axes.determinant() > 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  drop_small_pieces(mesh, least_mm3);
  return mesh;
}

void decimate_surface(ScanSurface& surface, const SurfaceOptions& options,
                      const Progress& progress) {
  surface.found_triangles = surface.mesh.triangles.size();
  if (options.target_triangles <= 0 || surface.mesh.triangles.empty()) return;
  report(progress, "decimating", 0);
  TriMesh coarse = simplify(surface.mesh, options.target_triangles);
  report(progress, "decimating", 0.8);
  const TriangleTree tree(coarse);
  constexpr std::size_t every = 7;
  std::vector<double> errors((surface.mesh.vertices.size() + every - 1) / every);
  parallel_for(errors.size(), options.threads, [&](std::size_t n) {
    errors[n] = tree.nearest(surface.mesh.vertices[n * every]).distance;
  });
  std::sort(errors.begin(), errors.end());
  surface.decimation_median_mm = errors[errors.size() / 2];
  surface.decimation_p95_mm = errors[errors.size() * 95 / 100];
  surface.decimation_max_mm = errors.back();
  surface.mesh = std::move(coarse);
  report(progress, "decimating", 1);
}

}  // namespace condyle
