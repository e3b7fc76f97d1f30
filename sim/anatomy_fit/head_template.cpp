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
  FitSurface prepared(std::move(surface), samples, threads);
  return prepared;
}

}  // namespace condyle
