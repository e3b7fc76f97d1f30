#include "sim/anatomy_fit/head_template.h"

#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/simplify.h"

namespace condyle {
namespace {

TriMesh coarse(const Case& model, Role role, int triangles) {
  const Part* part = model.find(role);
  if (!part) return {};
  TriMesh mesh = simplify(part->mesh, triangles);
  mesh.colors.clear();
  drop_unreferenced(mesh);
  return mesh;
}

/// The brain case is large and smooth: each of its points tells little.
void weigh(FitSurface& surface) {
  constexpr float vault = 0.3f, crowns = 0.5f;
  for (const auto& t : surface.mesh.triangles) {
    const Eigen::Vector3d& p = surface.mesh.vertices[static_cast<std::size_t>(t[0])];
    const bool smooth = p.z() > 45 || (p.z() > 0 && p.y() > -40);
    const bool teeth = p.z() < -38 && p.z() > -62 && p.y() < -40;
    surface.weights.push_back(smooth ? vault : teeth ? crowns : 1);
  }
}

TriMesh skull_of(const Case& model) {
  TriMesh mesh = coarse(model, Role::skull, 16000);
  append_surface(mesh, coarse(model, Role::upper_teeth, 5000));
  return mesh;
}

TriMesh jaw_of(const Case& model) {
  TriMesh mesh = coarse(model, Role::mandible, 10000);
  append_surface(mesh, coarse(model, Role::lower_teeth, 5000));
  return mesh;
}

TriMesh both(const Case& model) {
  TriMesh mesh = skull_of(model);
  append_surface(mesh, jaw_of(model));
  return mesh;
}

/// Whether rays along the normals meet the surface again more often than rays against them: on a
/// solid that faces outward, all rays against the normals do. Holds for open surfaces as well.
bool faces_inward(const TriMesh& surface) {
  constexpr int rays = 400;
  constexpr double lift_mm = 0.05;
  const TriangleTree tree(surface);
  int along = 0, against = 0;
  for (const auto& sample : sample_surface(surface, rays)) {
    const Eigen::Vector3d lift = lift_mm * sample.normal;
    along += tree.ray_cast(sample.point + lift, sample.normal) ? 1 : 0;
    against += tree.ray_cast(sample.point - lift, -sample.normal) ? 1 : 0;
  }
  return along > against;
}

}  // namespace

void append_surface(TriMesh& mesh, const TriMesh& other) {
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles)
    mesh.triangles.push_back(t + Eigen::Vector3i::Constant(first));
}

HeadTemplate::HeadTemplate(const Case& model, int threads)
    : skull(skull_of(model), 6000, threads),
      mandible(jaw_of(model), 3500, threads),
      whole(both(model), 5000, threads) {
  for (FitSurface* surface : {&skull, &mandible, &whole}) weigh(*surface);
}

FitSurface template_skin(const Case& model, int threads) {
  return {coarse(model, Role::face, 16000), 4000, threads};
}

FitSurface scanned_surface(TriMesh surface, int samples, int threads, const std::string& source) {
  constexpr int most_triangles = 150000;
  surface.colors.clear();
  weld(surface);
  drop_degenerate(surface);
  drop_unreferenced(surface);
  if (surface.empty()) throw InputError(source, "", "no triangles");
  if (static_cast<int>(surface.triangles.size()) > most_triangles)
    surface = simplify(surface, most_triangles);
  drop_unreferenced(surface);
  if (faces_inward(surface))
    throw InputError(
        source, "",
        "the surface faces inward: it was mirrored, so that left and right are exchanged, "
        "or its triangles are reversed");
  return {std::move(surface), samples, threads};
}

}  // namespace condyle
