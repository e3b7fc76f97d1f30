#include "sim/ct_case/fitted_seeds.h"

#include <algorithm>

namespace condyle {
namespace {

constexpr double least_error_mm = 1, most_error_mm = 3;

void append_part(TriMesh& mesh, const AnatomyFit& fit, Role role) {
  const CarriedPart* found = fit.find(role);
  if (!found) return;
  const TriMesh& other = found->part.mesh;
  const Eigen::Vector3i offset = Eigen::Vector3i::Constant(static_cast<int>(mesh.vertices.size()));
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back(t + offset);
}

SeedSurface seed_surface(const AnatomyFit& fit, Role bone, Role teeth, VoxelLabel label) {
  SeedSurface surface{{}, label};
  append_part(surface.mesh, fit, bone);
  append_part(surface.mesh, fit, teeth);
  return surface;
}

}  // namespace

FittedSeeds fitted_seeds(const AnatomyFit& fit) {
  FittedSeeds seeds;
  if (fit.skull.present)
    seeds.surfaces.push_back(seed_surface(fit, Role::skull, Role::upper_teeth, skull_label));
  if (fit.mandible.present)
    seeds.surfaces.push_back(seed_surface(fit, Role::mandible, Role::lower_teeth, mandible_label));
  seeds.error_mm =
      std::clamp(std::max(fit.skull.rms_mm, fit.mandible.rms_mm), least_error_mm, most_error_mm);
  return seeds;
}

}  // namespace condyle
