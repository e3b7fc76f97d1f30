#include "sim/phantom/surfaces.h"

#include "engine/field/decimate.h"
#include "engine/field/isosurface.h"

namespace condyle {

TriMesh symmetric_surface(const FieldRecipe& solid, const std::array<GridAxis, 3>& half_grid,
                          int triangles,
                          const std::function<double(const Eigen::Vector3d&)>& importance) {
  const TriMesh half = isosurface(sample_field(solid, half_grid));
  // Decimated before mirroring: half the work, and the halves are exact mirror images.
  return largest_piece(with_mirror_image(
      decimated(half, {.target_triangles = triangles / 2, .importance = importance})));
}

Part teeth_part(const PhantomSolid& solid, bool upper) {
  Part part;
  part.name = upper ? "upper_teeth" : "lower_teeth";
  part.role = upper ? Role::upper_teeth : Role::lower_teeth;
  part.body = default_body(part.role);
  std::vector<std::pair<int, TriMesh>> meshes;
  for (const auto& tooth : solid.teeth) {
    if ((tooth.fdi < 30) != upper) continue;
    // All teeth are sampled on one common grid, so that carved facets match their opponents.
    const double spacing = 0.3;
    const Eigen::Vector3d low = (tooth.box.min() / spacing).array().floor() * spacing;
    TriMesh mesh = largest_piece(
        isosurface(sample_field(tooth.solid, even_grid({low, tooth.box.max()}, spacing))));
    mesh = decimated(mesh, {.target_triangles = 2600, .evenness = 1e-4});
    meshes.emplace_back(tooth.right_fdi, mirror_image(mesh));
    meshes.emplace_back(tooth.fdi, std::move(mesh));
  }
  std::sort(meshes.begin(), meshes.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [fdi, mesh] : meshes) {
    const int base = static_cast<int>(part.mesh.vertices.size());
    part.teeth.push_back({fdi, static_cast<int>(part.mesh.triangles.size()),
                          static_cast<int>(mesh.triangles.size())});
    part.mesh.vertices.insert(part.mesh.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& t : mesh.triangles)
      part.mesh.triangles.emplace_back(t + Eigen::Vector3i::Constant(base));
  }
  return part;
}

}  // namespace condyle
