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
    : skull(skull_of(model), 5000, threads),
      mandible(jaw_of(model), 3000, threads),
      whole(both(model), 4000, threads) {}

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
