#include "sim/tissue/columns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/mesh/measure.h"
#include "engine/tissue/layered_mesh.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::vector<std::vector<int>> rings_of(const TriMesh& mesh) {
  std::vector<std::vector<int>> ring(mesh.vertices.size());
  for (const auto& [a, b] : edges_of(mesh.triangles)) {
    ring[a].push_back(b);
    ring[b].push_back(a);
  }
  return ring;
}

/// Inward directions: mean normals, averaged over several rings. The border of the mouth takes its
/// direction from the surrounding skin, since the lip's own normal turns into the mouth.
std::vector<Vector3d> smooth_inward(const CoarseSkin& skin,
                                    const std::vector<std::vector<int>>& ring, int rounds) {
  const auto normals = vertex_normals(skin.mesh);
  std::vector<Vector3d> inward(normals.size());
  for (std::size_t v = 0; v < normals.size(); ++v) inward[v] = -normals[v];
  std::vector<char> lip(normals.size(), 0);
  if (skin.mouth.found()) {
    for (int v : skin.mouth.upper) lip[v] = 1;
    for (int v : skin.mouth.lower) lip[v] = 1;
    lip[skin.mouth.left_corner] = lip[skin.mouth.right_corner] = 1;
  }
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vector3d> next = inward;
    for (std::size_t v = 0; v < inward.size(); ++v) {
      Vector3d sum = lip[v] ? Vector3d(0.2 * inward[v]) : inward[v];
      for (int n : ring[v])
        if (!lip[n] || lip[v]) sum += inward[n];
      next[v] = sum.normalized();
    }
    inward.swap(next);
  }
  return inward;
}

/// Where the ray from a point meets an eyeball, mm; 0 inside of it.
std::optional<double> to_globe(const Vector3d& from, const Vector3d& along, const Vector3d& globe) {
  constexpr double radius_mm = 12.2;
  const Vector3d across = globe - from;
  const double middle = across.dot(along);
  const double half = radius_mm * radius_mm - (across - middle * along).squaredNorm();
  if (half < 0 || middle < 0) return std::nullopt;
  return std::max(0.0, middle - std::sqrt(half));
}

void march(const CoarseSkin& skin, const Bones& bones, const ColumnSettings& settings,
           std::size_t v, Column& column) {
  const Vector3d& p = skin.mesh.vertices[v];
  const auto cranium = bones.cranium.empty()
                           ? std::nullopt
                           : bones.cranium.ray_cast(p, column.inward, settings.march_mm);
  const double before_bone = cranium ? cranium->distance : settings.march_mm;
  if (skin.eyes)
    for (const Eye* eye : {&skin.eyes->left, &skin.eyes->right})
      if (const auto met = to_globe(p, column.inward, eye->globe); met && *met < before_bone) {
        column.support = bones.jaw.upper_arch;
        column.met_globe = true;
        column.met_depth = *met;
        column.met_normal = (p + *met * column.inward - eye->globe).normalized();
        return;
      }
  const auto mandible = bones.mandible.empty()
                            ? std::nullopt
                            : bones.mandible.ray_cast(p, column.inward, settings.march_mm);
  if (!cranium && !mandible) return;
  const bool lower = mandible && (!cranium || mandible->distance < cranium->distance);
  const SurfacePoint& met = lower ? *mandible : *cranium;
  column.support = lower ? bones.jaw.lower_arch : bones.jaw.upper_arch;
  column.met_depth = met.distance;
  column.met_normal = (lower ? bones.mandible : bones.cranium).pseudonormal(met);
  if (!bones.teeth.empty()) {
    const auto tooth = bones.teeth.ray_cast(p, column.inward, settings.march_mm);
    column.met_teeth = tooth && tooth->distance < met.distance + 0.5;
  }
}

/// Depths of columns that hit nothing come from their neighbours; then all depths are smoothed
/// without exceeding what was hit.
void smooth_depths(const std::vector<std::vector<int>>& ring, const ColumnSettings& settings,
                   std::vector<Column>& columns) {
  const std::size_t count = columns.size();
  std::vector<double> depth(count), limit(count);
  for (std::size_t v = 0; v < count; ++v) {
    const double greatest =
        !columns[v].attached_to ? settings.greatest_free_depth_mm : settings.greatest_depth_mm;
    depth[v] = settings.default_depth_mm;
    limit[v] = greatest;
    if (!columns[v].support) continue;
    // A clearance remains in front of teeth: the lips slide on them.
    const double met = columns[v].met_depth - (columns[v].met_teeth ? 1.0 : 0.0);
    depth[v] = std::clamp(met, settings.min_depth_mm, greatest);
    limit[v] = std::clamp(met, settings.min_depth_mm, greatest);
  }
  for (int round = 0; round < settings.rounds(40); ++round)  // fill
    for (std::size_t v = 0; v < count; ++v) {
      if (columns[v].support) continue;
      const double drift = 1 / settings.finer;  // towards the default depth far from bone
      double sum = drift * settings.default_depth_mm;
      for (int n : ring[v]) sum += depth[n];
      depth[v] = sum / (drift + static_cast<double>(ring[v].size()));
    }
  for (int round = 0; round < settings.rounds(4); ++round) {
    std::vector<double> next(count);
    for (std::size_t v = 0; v < count; ++v) {
      double sum = 0;
      for (int n : ring[v]) sum += depth[n];
      next[v] =
          std::min(0.5 * depth[v] + 0.5 * sum / static_cast<double>(ring[v].size()), limit[v]);
    }
    depth.swap(next);
  }
  for (std::size_t v = 0; v < count; ++v) columns[v].depth = depth[v];
}

}  // namespace

Nodes column_nodes(const CoarseSkin& skin, const std::vector<Column>& columns,
                   const ColumnSettings& settings) {
  const int sheets = static_cast<int>(settings.layer_fraction.size()) + 1;
  Nodes nodes(columns.size() * sheets);
  for (std::size_t v = 0; v < columns.size(); ++v) {
    double fraction = 0;
    for (int sheet = 0; sheet < sheets; ++sheet) {
      nodes[node_of(static_cast<int>(v), sheet, sheets)] =
          skin.mesh.vertices[v] + fraction * columns[v].depth * columns[v].inward;
      if (sheet + 1 < sheets) fraction += settings.layer_fraction[sheet];
    }
  }
  return nodes;
}

std::vector<Column> march_columns(const CoarseSkin& skin, const Bones& bones,
                                  const ColumnSettings& settings) {
  const auto ring = rings_of(skin.mesh);
  std::vector<Column> columns(skin.mesh.vertices.size());
  const auto inward = smooth_inward(skin, ring, settings.rounds(8));
  for (std::size_t v = 0; v < columns.size(); ++v) {
    columns[v].inward = inward[v];
    march(skin, bones, settings, v, columns[v]);
    const auto near_lip = [&](int lip) {
      columns[v].to_mouth =
          std::min(columns[v].to_mouth, (skin.mesh.vertices[lip] - skin.mesh.vertices[v]).norm());
    };
    if (skin.mouth.found()) {
      for (int lip : skin.mouth.upper) near_lip(lip);
      for (int lip : skin.mouth.lower) near_lip(lip);
      near_lip(skin.mouth.left_corner);
      near_lip(skin.mouth.right_corner);
    }
  }
  return columns;
}

bool ShapedColumns::sound() const {
  return std::find(folded.begin(), folded.end(), 1) == folded.end();
}

ShapedColumns shape_columns(const CoarseSkin& skin, const ColumnSettings& settings,
                            std::vector<Column>& columns) {
  const auto ring = rings_of(skin.mesh);
  smooth_depths(ring, settings, columns);

  // Thins the columns of degenerate prisms and turns them towards the prism's normal and their
  // neighbours until all are sound.
  const int sheets = static_cast<int>(settings.layer_fraction.size()) + 1;
  std::vector<char> changed(columns.size(), 0);
  ShapedColumns shaped;
  for (int round = 0; round < 80; ++round) {
    const Nodes nodes = column_nodes(skin, columns, settings);
    std::vector<char> weak(columns.size(), 0);
    std::vector<Vector3d> towards(columns.size(), Vector3d::Zero());
    for (const auto& t : skin.mesh.triangles) {
      const Vector3d& p = skin.mesh.vertices[t[0]];
      const double area =
          0.5 * (skin.mesh.vertices[t[1]] - p).cross(skin.mesh.vertices[t[2]] - p).norm();
      const double depth = (columns[t[0]].depth + columns[t[1]].depth + columns[t[2]].depth) / 3;
      for (int layer = 0; layer + 1 < sheets; ++layer) {
        std::array<int, 6> prism;
        for (int k = 0; k < 3; ++k) {
          prism[k] = node_of(t[k], layer, sheets);
          prism[k + 3] = node_of(t[k], layer + 1, sheets);
        }
        if (prism_volume(nodes, prism) > 0.3 * area * depth * settings.layer_fraction[layer])
          continue;
        const Vector3d below =
            -(skin.mesh.vertices[t[1]] - p).cross(skin.mesh.vertices[t[2]] - p).normalized();
        for (int k = 0; k < 3; ++k) {
          weak[t[k]] = 1;
          towards[t[k]] += below;
        }
        break;
      }
    }
    shaped.folded = weak;
    if (shaped.sound()) break;
    const auto before = columns;
    for (std::size_t v = 0; v < columns.size(); ++v) {
      if (!weak[v]) continue;
      changed[v] = 1;
      columns[v].depth = std::max(0.93 * columns[v].depth, std::min(2.0, columns[v].depth));
      Vector3d sum = before[v].inward + 0.5 * towards[v].normalized();
      for (int n : ring[v]) sum += before[n].inward / static_cast<double>(ring[v].size());
      columns[v].inward = sum.normalized();
    }
  }
  shaped.thinned = static_cast<int>(std::count(changed.begin(), changed.end(), 1));
  return shaped;
}

void relax_folds(CoarseSkin& skin, const std::vector<char>& folded, int rings) {
  const auto ring = rings_of(skin.mesh);
  std::vector<char> moves = folded;
  for (int grown = 0; grown < rings; ++grown) {
    const std::vector<char> inner = moves;
    for (std::size_t v = 0; v < inner.size(); ++v)
      if (inner[v])
        for (int n : ring[v]) moves[n] = 1;
  }
  constexpr int borders_stay = 3;  // rings; a sharp bend of a border may move after that
  std::vector<std::vector<int>> means = ring;  // of each vertex that moves
  for (const auto& loop : border_loops(skin.mesh)) {
    const bool is_mouth = std::find(loop.begin(), loop.end(), skin.mouth.left_corner) != loop.end();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int v = loop[i];
      moves[v] = rings > borders_stay && !is_mouth && folded[v];
      means[v] = {loop[(i + loop.size() - 1) % loop.size()], loop[(i + 1) % loop.size()]};
    }
  }
  for (int round = 0; round < 3; ++round) {
    const auto before = skin.mesh.vertices;
    for (std::size_t v = 0; v < moves.size(); ++v) {
      if (!moves[v]) continue;
      Vector3d sum = Vector3d::Zero();
      for (int n : means[v]) sum += before[n];
      skin.mesh.vertices[v] = 0.5 * before[v] + 0.5 * sum / static_cast<double>(means[v].size());
    }
  }
}

void unfold_ears(CoarseSkin& skin, const std::vector<char>& folded) {
  constexpr double min_height = 0.3;  // over the edge's length
  const TriMesh& mesh = skin.mesh;
  std::vector<int> uses(folded.size(), 0);
  for (const auto& t : mesh.triangles)
    for (int v : t) ++uses[v];
  for (const auto& ear : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const int tip = ear[k], a = ear[(k + 1) % 3], b = ear[(k + 2) % 3];
      if (uses[tip] != 1 || !folded[tip]) continue;
      for (const auto& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
          if (t[i] != b || t[(i + 1) % 3] != a) continue;
          const Vector3d &pa = mesh.vertices[a], &pb = mesh.vertices[b];
          const Vector3d edge = pb - pa, across = mesh.vertices[t[(i + 2) % 3]] - pa;
          const Vector3d away =
              (edge.dot(across) / edge.squaredNorm() * edge - across).normalized();
          skin.mesh.vertices[tip] = 0.5 * (pa + pb) + min_height * edge.norm() * away;
        }
    }
}

}  // namespace condyle
