#include "render/scene/drawable.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/triangle_tree.h"
#include "render/face/lashes.h"
#include "render/face/neck_cut.h"
#include "render/face/shade_layers.h"
#include "render/face/skin_folds.h"
#include "render/face/tongue_relief.h"
#include "render/face/tooth_tint.h"
#include "render/mesh/ambient_occlusion.h"
#include "render/mesh/cut_cover.h"
#include "render/mesh/vertex_normals.h"
#include "render/shaders/skin_table.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr int occlusion_directions = 48;
constexpr int bake_threads = 2;

/// 0 to 1 by the position in a lattice of 1 mm cells; deterministic.
float lattice(int x, int y, int z) {
  const int cell[3] = {x, y, z};
  return static_cast<float>(hash_bytes(cell, sizeof cell) >> 40) / static_cast<float>(1 << 24);
}

/// Smooth noise, -1 to 1.
float noise(const Eigen::Vector3f& p) {
  const Eigen::Vector3f base = p.array().floor();
  const Eigen::Vector3f f = p - base;
  const Eigen::Vector3f s = f.array().square() * (3 - 2 * f.array());
  const Eigen::Vector3i c = base.cast<int>();
  float sum = 0;
  for (int k = 0; k < 8; ++k) {
    const int dx = k & 1, dy = k >> 1 & 1, dz = k >> 2;
    sum += (dx ? s.x() : 1 - s.x()) * (dy ? s.y() : 1 - s.y()) * (dz ? s.z() : 1 - s.z()) *
           lattice(c.x() + dx, c.y() + dy, c.z() + dz);
  }
  return 2 * sum - 1;
}

/// Skin colour varies: patches with more blood, and fine unevenness.
Eigen::Vector3f mottled(const Eigen::Vector3f& color, const Eigen::Vector3f& p) {
  const float blood = 0.6f * noise(p / 13) + 0.4f * noise(p / 5), grain = noise(p / 1.7f);
  return color.cwiseProduct(Eigen::Vector3f(1 + 0.008f * blood + 0.012f * grain,
                                            1 - 0.022f * blood + 0.016f * grain,
                                            1 - 0.026f * blood + 0.018f * grain));
}

/// Sends the places that the fine relief of skin or a tongue is tied to.
void send_rest_of(Role role, std::span<const Eigen::Vector3f> places, GpuMesh& mesh) {
  if (role == Role::face) mesh.send_rest(places);
  if (role == Role::tongue) mesh.send_rest(unrolled_tongue(places));
}

/// Box that contains the red of the lips: the ellipsoid inscribed in it does.
Eigen::AlignedBox3f lips_about(std::span<const int> rim, std::span<const Eigen::Vector3f> places) {
  Eigen::AlignedBox3f box;
  for (const int v : rim) box.extend(places[static_cast<std::size_t>(v)]);
  const float width = box.sizes().x();
  const Eigen::Vector3f middle = box.center(), half = width * Eigen::Vector3f(0.62f, 0.62f, 0.42f);
  return {middle - half, middle + half};
}

/// What the pictures of a face with a mouth have. rim: of the mouth.
void add_looks_of_mouth(Drawable& face, std::span<const Eigen::Vector3f> positions,
                        std::span<const Eigen::Vector3f> normals, std::span<const int> rim,
                        std::span<const Part* const> parts) {
  face.lips = lips_about(rim, positions);
  face.neck_cut = find_neck_cut(positions, face.triangles(), rim);
  face.folds = std::make_shared<const SkinFolds>(positions, normals, face.triangles(), rim);
  face.cheeks = std::make_shared<const CheekThickness>(positions, normals, rim, parts);
  face.pad = std::make_shared<const SubmentalPad>(positions, face.triangles(), rim);
}

/// Mean colour of a face's skin about the lashes, sRGB; none without.
std::optional<Eigen::Vector3f> skin_about(const TriMesh& eyes, std::span<const float> lash_radius,
                                          const TriMesh* face) {
  constexpr double about_mm = 3;
  if (!face || face->colors.size() != face->vertices.size()) return std::nullopt;
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v < lash_radius.size(); ++v)
    if (lash_radius[v] > 0) box.extend(eyes.vertices[v]);
  if (box.isEmpty()) return std::nullopt;
  box.extend(Eigen::Vector3d(box.min().array() - about_mm));
  box.extend(Eigen::Vector3d(box.max().array() + about_mm));
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float count = 0;
  for (std::size_t v = 0; v < face->vertices.size(); ++v)
    if (box.contains(face->vertices[v])) sum += face->colors[v], ++count;
  if (count == 0) return std::nullopt;
  return Eigen::Vector3f(sum / count);
}

/// Tongues bend in pictures alone.
bool keeps_shape(Role role) { return is_rigid(role) && role != Role::tongue; }

struct Prepared {
  std::vector<Eigen::Vector3f> positions, normals;
};

/// Median luminance, linear, of sRGB colours.
float median_light(std::span<const GpuMesh::Bytes> colors) {
  std::vector<float> light;
  light.reserve(colors.size());
  for (const auto& c : colors)
    light.push_back(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f)
                        .dot(Eigen::Vector3f(c[0], c[1], c[2]).array().pow(2.2f).matrix()) /
                    std::pow(255.f, 2.2f));
  if (light.empty()) return 0;
  const auto middle = light.begin() + static_cast<std::ptrdiff_t>(light.size() / 2);
  std::nth_element(light.begin(), middle, light.end());
  return *middle;
}

void add_traits_of_role(Drawable& made) {
  if (made.part->role == Role::face) made.skin_light = median_light(made.colors);
  made.papillae = made.part->role == Role::tongue;
}

}  // namespace

std::vector<Drawable> make_drawables(std::span<const Part* const> parts, const MouthLining* mouth) {
  std::vector<Prepared> prepared(parts.size());
  std::vector<OcclusionSurface> surfaces(parts.size());
  std::vector<Part> heads;  // without meshes
  for (const Part* part : parts) heads.push_back({part->name, part->role, {}, {}, part->body});
  const BodyId lower_jaw = lower_jaw_of(heads);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    auto& [positions, normals] = prepared[p];
    positions.reserve(parts[p]->mesh.vertices.size());
    for (const auto& v : parts[p]->mesh.vertices) positions.push_back(v.cast<float>());
    vertex_normals(positions, parts[p]->mesh.triangles, normals);
    surfaces[p] = {positions, normals, parts[p]->mesh.triangles};
    set_shade_layers(*parts[p], lower_jaw, surfaces[p]);
  }
  const auto occlusion =
      stored_occlusion(user_cache_folder(), surfaces, occlusion_directions, bake_threads);

  const auto face = std::find_if(parts.begin(), parts.end(),
                                 [](const Part* part) { return part->role == Role::face; });
  std::vector<Drawable> drawables;
  drawables.reserve(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Part& part = *parts[p];
    auto& [positions, normals] = prepared[p];
    std::vector<Eigen::Vector3i> own;
    std::vector<int> uneven, mouth_rim;
    if (part.role == Role::face && mouth) {
      own = mouth->face;
      mouth_rim = mouth->rim;
      if (mouth->cut) uneven = mouth->rim;
      mouth = nullptr;
    }
    even_rim(positions, uneven);
    const auto& triangles = own.empty() ? part.mesh.triangles : own;
    if (!own.empty()) vertex_normals(positions, triangles, normals);
    const auto use = keeps_shape(part.role) ? GpuMesh::Use::still : GpuMesh::Use::moving;
    const bool own_colors = part.mesh.colors.size() == positions.size();
    const auto material = material_of(part.role);
    std::vector<float> trait(positions.size(), 0);  // by its role
    if (part.role == Role::face) {
      trait = vertex_curvature(positions, triangles, normals);
      for (float& value : trait) value /= SkinTable::max_curvature;
    } else if (part.role == Role::tongue) {
      std::transform(normals.begin(), normals.end(), trait.begin(), smoothness_of_tongue);
    }
    const auto tints = own_colors ? std::vector<Eigen::Vector3f>{} : tooth_tint(part);
    std::vector<float> lash_radius(positions.size(), 0);
    if (part.role == Role::eyes) lash_radius = lash_radii(part.mesh);
    std::vector<GpuMesh::Bytes> colors(positions.size()), extras(positions.size());
    Eigen::AlignedBox3f box;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      box.extend(positions[i]);
      Eigen::Vector3f color = own_colors ? part.mesh.colors[i] : material.color;
      // Lips are redder and moister than skin.
      const float redness = (color.x() - color.y()) / std::max(color.x(), 0.05f);
      const float gloss = own_colors ? std::clamp((redness - 0.30f) / 0.18f, 0.f, 1.f) : 0.f;
      if (part.role == Role::face) color = mottled(color, positions[i]);
      if (!tints.empty()) color = color.cwiseProduct(tints[i]);
      colors[i] = {to_byte(color.x()), to_byte(color.y()), to_byte(color.z()),
                   to_byte(occlusion[p].together[i])};
      extras[i] = {to_byte(occlusion[p].alone[i]), to_byte(trait[i]), to_byte(gloss),
                   to_byte(lash_radius[i] / thickest_lash_mm)};
    }
    GpuMesh mesh(positions, triangles, use);
    mesh.add_coarse(positions, triangles);
    mesh.send_shape(positions, normals);
    mesh.send_colors(colors);
    mesh.send_extras(extras);
    send_rest_of(part.role, positions, mesh);
    std::vector<Crease> creases;
    if (part.role == Role::face) creases = find_creases(positions, normals, occlusion[p].together);
    std::optional<SurfaceEdges> edges, coarse_edges;
    if (part.role == Role::face) {
      edges.emplace(mesh.fine().triangles);
      coarse_edges.emplace(mesh.coarse().triangles);
    }
    drawables.push_back({&part, material, is_closed_surface(triangles), box, std::move(mesh),
                         std::move(creases), std::move(colors), std::move(extras), std::move(edges),
                         std::move(coarse_edges)});
    drawables.back().own = std::move(own);
    add_traits_of_role(drawables.back());
    drawables.back().uneven = std::move(uneven);
    if (part.role == Role::eyes)
      drawables.back().behind_lashes =
          skin_about(part.mesh, lash_radius, face == parts.end() ? nullptr : &(*face)->mesh);
    if (!mouth_rim.empty())
      add_looks_of_mouth(drawables.back(), positions, normals, mouth_rim, parts);
  }
  return drawables;
}

std::vector<Drawable> drawables_like(std::span<const Drawable> others) {
  std::vector<Drawable> drawables;
  drawables.reserve(others.size());
  for (const auto& other : others) {
    const Part& part = *other.part;
    std::vector<Eigen::Vector3f> positions, normals;
    for (const auto& v : part.mesh.vertices) positions.push_back(v.cast<float>());
    even_rim(positions, other.uneven);
    vertex_normals(positions, other.triangles(), normals);
    GpuMesh mesh = other.mesh.twin();
    mesh.send_shape(positions, normals);
    mesh.send_colors(other.colors);
    mesh.send_extras(other.extras);
    send_rest_of(part.role, positions, mesh);
    drawables.push_back({&part, other.material, other.closed, other.box, std::move(mesh),
                         other.creases, other.colors, other.extras, other.edges,
                         other.coarse_edges});
    drawables.back().own = other.own;
    drawables.back().papillae = other.papillae;
    drawables.back().uneven = other.uneven;
    drawables.back().behind_lashes = other.behind_lashes;
    drawables.back().folds = other.folds;
    drawables.back().cheeks = other.cheeks;
    drawables.back().pad = other.pad;
    drawables.back().lips = other.lips;
    drawables.back().neck_cut = other.neck_cut;
    drawables.back().skin_light = other.skin_light;
  }
  return drawables;
}

Drawable piece_of(const Drawable& whole, std::span<const Eigen::Vector3i> triangles) {
  std::vector<Eigen::Vector3f> positions, normals;
  for (const auto& v : whole.part->mesh.vertices) positions.push_back(v.cast<float>());
  vertex_normals(positions, triangles, normals);
  Eigen::AlignedBox3f box;
  for (const auto& t : triangles)
    for (const int v : t) box.extend(positions[static_cast<std::size_t>(v)]);
  GpuMesh mesh(positions, triangles, GpuMesh::Use::still);
  mesh.send_shape(positions, normals);
  mesh.send_colors(whole.colors);
  mesh.send_extras(whole.extras);
  Drawable piece{whole.part,
                 whole.material,
                 is_closed_surface(triangles),
                 box,
                 std::move(mesh),
                 {},
                 whole.colors,
                 whole.extras,
                 {},
                 {}};
  piece.own.assign(triangles.begin(), triangles.end());
  return piece;
}

void Drawable::set_finer(const TriMesh& surface, std::span<const Eigen::Vector3f> normals) {
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(surface.vertices.size());
  for (const auto& v : surface.vertices) positions.push_back(v.cast<float>());
  finer_vertices = positions.size();
  finer.emplace(positions, surface.triangles, GpuMesh::Use::still);
  finer->send_shape(positions, normals);
  // A map is not shaded by these, but the driver reads them.
  const std::vector<GpuMesh::Bytes> none(positions.size());
  finer->send_colors(none);
  finer->send_extras(none);
  undressed = std::move(positions);
}

void Drawable::dress_finer() {
  if (undressed.empty()) return;
  const TriangleTree tree(part->mesh);
  std::vector<GpuMesh::Bytes> fine_colors(undressed.size()), fine_extras(undressed.size());
  for (std::size_t v = 0; v < undressed.size(); ++v) {
    const SurfacePoint at = tree.nearest(undressed[v].cast<double>());
    if (at.triangle < 0) continue;
    const auto& corners = part->mesh.triangles[static_cast<std::size_t>(at.triangle)];
    for (std::size_t k = 0; k < 4; ++k) {
      double color = 0, extra = 0;
      for (int c = 0; c < 3; ++c) {
        const auto corner = static_cast<std::size_t>(corners[c]);
        color += at.barycentric[c] * colors[corner][k];
        extra += at.barycentric[c] * extras[corner][k];
      }
      fine_colors[v][k] = to_byte(static_cast<float>(color / 255));
      fine_extras[v][k] = to_byte(static_cast<float>(extra / 255));
    }
  }
  finer->send_colors(fine_colors);
  finer->send_extras(fine_extras);
  undressed.clear();
}

void Drawable::cover(std::span<const Eigen::Vector3i> closed_otherwise) {
  if (covered) return;
  std::vector<Eigen::Vector3i> all(triangles().begin(), triangles().end());
  all.insert(all.end(), closed_otherwise.begin(), closed_otherwise.end());
  mesh.send_cover(cover_rims(all));
  covered = true;
}

const GpuMesh& Drawable::rest_mesh() {
  if (keeps_shape(part->role)) return mesh;
  if (!at_rest) {
    std::vector<Eigen::Vector3f> positions, normals;
    for (const auto& v : part->mesh.vertices) positions.push_back(v.cast<float>());
    even_rim(positions, uneven);
    vertex_normals(positions, triangles(), normals);
    at_rest.emplace(positions, triangles(), GpuMesh::Use::still);
    at_rest->send_shape(positions, normals);
    at_rest->send_colors(colors);
    at_rest->send_extras(extras);
  }
  at_rest->send_displacements_to(mesh);
  return *at_rest;
}

void Drawable::move_face(std::vector<Eigen::Vector3f> positions, const FaceLook& look,
                         std::vector<Eigen::Vector3f>& normals_scratch) {
  even_rim(positions, uneven);
  if (pad && look.folded) pad->apply(positions);
  auto shades = folds && look.folded ? folds->apply(positions) : std::vector<SkinFolds::Shade>{};
  if (cheeks && look.folded)
    for (const SkinFolds::Shade& shade : cheeks->apply(positions)) shades.push_back(shade);
  if (look.alive)
    for (const SkinFolds::Shade& shade : look.alive(positions)) shades.push_back(shade);
  if (look.relief || relief_moved) {
    std::vector<Eigen::Vector3f> tied;
    for (const auto& v : part->mesh.vertices) tied.push_back(v.cast<float>());
    even_rim(tied, uneven);
    if (look.relief) look.relief(tied);
    mesh.send_rest(tied);
    relief_moved = static_cast<bool>(look.relief);
  }
  vertex_normals(positions, triangles(), normals_scratch);
  mesh.send_shape(positions, normals_scratch);
  auto now = colors;
  for (const auto& crease : creases) {
    auto& sky = now[static_cast<std::size_t>(crease.vertex)][3];
    sky = to_byte(opened_sky(crease, static_cast<float>(sky) / 255, positions));
  }
  const auto darken = [](std::uint8_t& sky, float factor) {
    sky = to_byte(factor * static_cast<float>(sky) / 255);
  };
  for (const auto& [vertex, sky] : shades) darken(now[static_cast<std::size_t>(vertex)][3], sky);
  if (!creases.empty() || folds) mesh.send_colors(now);
  if (!folds) return;
  auto alone = extras;
  for (const auto& [vertex, sky] : shades) darken(alone[static_cast<std::size_t>(vertex)][0], sky);
  mesh.send_extras(alone);
}

}  // namespace condyle
