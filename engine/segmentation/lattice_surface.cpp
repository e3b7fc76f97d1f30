#include "engine/segmentation/lattice_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "engine/core/parallel.h"
#include "engine/field/isosurface.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/pieces.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/self_crossings.h"
#include "engine/mesh/simplify.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/mesh/unfold.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

GridAxis steps(int count) {
  GridAxis axis(static_cast<std::size_t>(count));
  std::iota(axis.begin(), axis.end(), 0.0);
  return axis;
}

/// Vertices at edges that have other than two triangles in opposite directions.
std::vector<int> open_vertices(const TriMesh& mesh) {
  const EdgeList edges = find_edges(mesh);
  std::vector<int> vertices;
  for (const Edge& edge : edges.edges) {
    const EdgeSide* side = edges.sides.data() + edge.first;
    if (edge.count == 2 && side[0].forward != side[1].forward) continue;
    vertices.push_back(edge.low);
    vertices.push_back(edge.high);
  }
  return vertices;
}

/// Marks the triangles within some rings of neighbours of the vertices.
void mark_around(const TriMesh& mesh, const std::vector<int>& vertices, int rings,
                 std::vector<char>& marked) {
  std::vector<char> near(mesh.vertices.size(), 0);
  for (const int v : vertices) near[static_cast<std::size_t>(v)] = 1;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<char> next = near;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      bool touches = false;
      for (int c = 0; c < 3; ++c)
        touches = touches || near[static_cast<std::size_t>(mesh.triangles[t][c])];
      if (!touches) continue;
      marked[t] = 1;
      for (int c = 0; c < 3; ++c) next[static_cast<std::size_t>(mesh.triangles[t][c])] = 1;
    }
    near.swap(next);
  }
}

std::vector<int> corners_of(const TriMesh& mesh, const std::vector<int>& triangles) {
  std::vector<int> corners;
  for (const int t : triangles)
    for (const int v : mesh.triangles[static_cast<std::size_t>(t)]) corners.push_back(v);
  return corners;
}

/// About so many triangles, closed: where collapsed edges would open the surface, or let it pass
/// through itself, its triangles stay as they are. Empty when that does not succeed.
TriMesh decimated_closed(const TriMesh& mesh, int target, int threads) {
  constexpr int rounds = 6;
  const Vector3d middle = bounding_box(mesh).center();
  std::vector<Eigen::Vector3f> positions;
  for (const Vector3d& p : mesh.vertices) positions.push_back((p - middle).cast<float>());
  std::vector<char> kept(mesh.triangles.size(), 0);
  std::vector<char> crossed(mesh.vertices.size(), 0);
  for (const int v : corners_of(mesh, self_crossings(mesh, threads)))
    crossed[static_cast<std::size_t>(v)] = 1;
  TriMesh closed;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vector3i> free, result;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      (kept[t] ? result : free).push_back(mesh.triangles[t]);
    const int left = std::max(target - static_cast<int>(result.size()), target / 4);
    const auto coarse =
        coarser(positions, free, left, bounding_box(mesh).size().norm(), Rims::fixed);
    result.insert(result.end(), coarse.begin(), coarse.end());
    drop_flaps(result);
    TriMesh decimated{mesh.vertices, std::move(result), {}};
    std::vector<int> wrong = open_vertices(decimated);
    if (wrong.empty()) {
      wrong = corners_of(decimated, self_crossings(decimated, threads));
      std::erase_if(wrong, [&](int v) { return crossed[static_cast<std::size_t>(v)] != 0; });
      closed = std::move(decimated);
      if (wrong.empty()) break;
    }
    mark_around(mesh, wrong, 3 + round, kept);
  }
  drop_unreferenced(closed);
  return closed;
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
  const Components pieces = find_components(mesh);
  drop_components_below(mesh, pieces, component_volumes(mesh, pieces), least_mm3);
  return mesh;
}

void decimate_surface(ScanSurface& surface, Flaws worse, const SurfaceOptions& options,
                      const Progress& progress) {
  surface.found_triangles = surface.mesh.triangles.size();
  if (options.target_triangles <= 0 || surface.mesh.triangles.empty()) return;
  report(progress, "decimating", 0);
  TriMesh coarse;
  if (static_cast<int>(surface.mesh.triangles.size()) > options.target_triangles)
    coarse = decimated_closed(surface.mesh, options.target_triangles, options.threads);
  if (coarse.empty()) coarse = simplify(surface.mesh, options.target_triangles);
  if (worse == Flaws::crossings)
    unfold_apart(coarse, {}, options.threads);
  else
    unfold(coarse);
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
