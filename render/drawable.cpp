#include "render/drawable.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "render/ambient_occlusion.h"
#include "render/skin_table.h"
#include "render/vertex_normals.h"

namespace condyle {
namespace {

constexpr int occlusion_directions = 48;
constexpr int bake_threads = 2;

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.f, 1.f)));
}

/// What shades what: bones of each body among themselves, at rest the other body too; the eyes lie
/// under the lids; the face is shaded by itself alone, for bones under it are not seen beside it.
void set_layers(Role role, OcclusionSurface& surface) {
  enum { cranium, mandible, face };
  if (role == Role::face) {
    surface.layer = face;
    surface.alone = surface.together = 1u << face;
  } else if (role == Role::eyes) {
    surface.layer = cranium;
    surface.alone = 1u << cranium;
    surface.together = 1u << cranium | 1u << face;
  } else {
    surface.layer = body_of(role) == Body::mandible ? mandible : cranium;
    surface.alone = 1u << surface.layer;
    surface.together = 1u << cranium | 1u << mandible;
  }
}

struct Prepared {
  std::vector<Eigen::Vector3f> positions, normals;
};

}  // namespace

std::vector<Drawable> make_drawables(std::span<const Part> parts) {
  std::vector<Prepared> prepared(parts.size());
  std::vector<OcclusionSurface> surfaces(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    auto& [positions, normals] = prepared[p];
    positions.reserve(parts[p].mesh.vertices.size());
    for (const auto& v : parts[p].mesh.vertices) positions.push_back(v.cast<float>());
    vertex_normals(positions, parts[p].mesh.triangles, normals);
    surfaces[p] = {positions, normals, parts[p].mesh.triangles};
    set_layers(parts[p].role, surfaces[p]);
  }
  const auto occlusion = bake_occlusion(surfaces, occlusion_directions, bake_threads);

  std::vector<Drawable> drawables;
  drawables.reserve(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto& part = parts[p];
    const auto& [positions, normals] = prepared[p];
    const bool moving = body_of(part.role) == Body::tissue;
    const bool own_colors = part.mesh.colors.size() == positions.size();
    const auto material = material_of(part.role);
    std::vector<float> curvature;
    if (part.role == Role::face)
      curvature = vertex_curvature(positions, part.mesh.triangles, normals);
    std::vector<GpuMesh::Bytes> colors(positions.size()), extras(positions.size());
    Eigen::AlignedBox3f box;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      box.extend(positions[i]);
      const Eigen::Vector3f color = own_colors ? part.mesh.colors[i] : material.color;
      colors[i] = {to_byte(color.x()), to_byte(color.y()), to_byte(color.z()),
                   to_byte(occlusion[p].together[i])};
      // Lips are redder than skin, and moister.
      const float redness = (color.x() - color.y()) / std::max(color.x(), 0.05f);
      const float gloss = own_colors ? std::clamp((redness - 0.30f) / 0.18f, 0.f, 1.f) : 0.f;
      extras[i] = {to_byte(occlusion[p].alone[i]),
                   to_byte(curvature.empty() ? 0.f : curvature[i] / SkinTable::max_curvature),
                   to_byte(gloss), 0};
    }
    GpuMesh mesh(part.mesh.triangles, moving);
    mesh.send_shape(positions, normals);
    mesh.send_look(colors, extras);
    const Eigen::Vector3f centre =
        box.isEmpty() ? Eigen::Vector3f::Zero() : Eigen::Vector3f(box.center());
    drawables.push_back(
        {&part, material, is_closed_surface(part.mesh.triangles), std::move(mesh), centre});
  }
  return drawables;
}

}  // namespace condyle
