#include "render/mesh/ambient_occlusion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/core/archive.h"
#include "engine/core/parallel.h"
#include "engine/core/user_cache.h"

namespace condyle {
namespace {

constexpr int layers = 4;
constexpr int map_side = 256;  // cells of a depth map: about 1 mm on a head
constexpr float nothing = -std::numeric_limits<float>::infinity();

/// Depth maps of all layers from one side; the larger depth is nearer to the sky.
struct Sky {
  Eigen::Matrix3f rows;  // u, v in cells and depth in mm, of p - centre
  Eigen::Vector3f direction;
  std::array<std::vector<float>, layers> depth;
};

/// Uniformly distributed directions (a Fibonacci spiral).
Eigen::Vector3f spread(int i, int count) {
  const double z = 1 - (2.0 * i + 1) / count, r = std::sqrt(1 - z * z);
  const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
  return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
}

void draw_triangle(std::vector<float>& depth, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                   const Eigen::Vector3f& c) {
  const int u0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}))));
  const int u1 =
      std::min(map_side - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}))));
  const int v0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}))));
  const int v1 =
      std::min(map_side - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}))));
  if (u0 > u1 || v0 > v1) return;
  const float abx = b.x() - a.x(), aby = b.y() - a.y(), acx = c.x() - a.x(), acy = c.y() - a.y();
  const float area = abx * acy - aby * acx;
  if (area == 0) return;
  for (int v = v0; v <= v1; ++v)
    for (int u = u0; u <= u1; ++u) {
      const float px = static_cast<float>(u) - a.x(), py = static_cast<float>(v) - a.y();
      const float s = (px * acy - py * acx) / area, t = (abx * py - aby * px) / area;
      if (s < 0 || t < 0 || s + t > 1) continue;
      float& cell = depth[static_cast<std::size_t>(v) * map_side + u];
      cell = std::max(cell, a.z() + s * (b.z() - a.z()) + t * (c.z() - a.z()));
    }
}

/// 0 in full shade to 1 unoccluded, for a point in map coordinates.
float open_fraction(const std::vector<float>& depth, const Eigen::Vector3f& q, float bias) {
  const int u = static_cast<int>(std::floor(q.x())), v = static_cast<int>(std::floor(q.y()));
  if (u < 0 || v < 0 || u + 1 >= map_side || v + 1 >= map_side) return 1;
  const float fu = q.x() - static_cast<float>(u), fv = q.y() - static_cast<float>(v);
  const auto open = [&](int i, int j) {
    return depth[static_cast<std::size_t>(v + j) * map_side + u + i] > q.z() + bias ? 0.f : 1.f;
  };
  return (1 - fv) * ((1 - fu) * open(0, 0) + fu * open(1, 0)) +
         fv * ((1 - fu) * open(0, 1) + fu * open(1, 1));
}

void draw_sky(Sky& sky, std::span<const OcclusionSurface> surfaces, const Eigen::Vector3f& centre) {
  for (auto& map : sky.depth) map.assign(std::size_t{map_side} * map_side, nothing);
  std::vector<Eigen::Vector3f> placed;
  for (const auto& surface : surfaces) {
    placed.resize(surface.vertices.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      placed[i] = sky.rows * (surface.vertices[i] - centre);
      placed[i].head<2>().array() += 0.5f * map_side;
    }
    auto& map = sky.depth[surface.layer];
    for (const auto& t : surface.triangles)
      draw_triangle(map, placed[t[0]], placed[t[1]], placed[t[2]]);
  }
}

/// Mean with the neighbours along the edges: removes the noise of the few directions.
void smooth(std::vector<float>& values, std::span<const Eigen::Vector3i> triangles) {
  std::vector<float> sum(values.size(), 0), count(values.size(), 0);
  for (const auto& t : triangles) {
    const float all = values[t[0]] + values[t[1]] + values[t[2]];
    for (int k = 0; k < 3; ++k) {
      sum[t[k]] += all;
      count[t[k]] += 3;
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    if (count[i] > 0) values[i] = sum[i] / count[i];
}

}  // namespace

std::vector<Occlusion> bake_occlusion(std::span<const OcclusionSurface> surfaces, int directions,
                                      int threads) {
  Eigen::AlignedBox3f box;
  std::vector<Occlusion> result(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (const auto& p : surfaces[s].vertices) box.extend(p);
    result[s].alone.assign(surfaces[s].vertices.size(), 0);
    result[s].together.assign(surfaces[s].vertices.size(), 0);
  }
  if (box.isEmpty()) return result;
  const Eigen::Vector3f centre = box.center();
  const float cell_mm = std::max(box.diagonal().norm(), 1e-3f) / (map_side - 4);

  // Ranges of vertices, so that threads share the work evenly whatever the sizes of the parts.
  struct Run {
    std::size_t surface, first, last;
  };
  std::vector<Run> runs;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (std::size_t i = 0; i < surfaces[s].vertices.size(); i += 4096)
      runs.push_back({s, i, std::min(i + 4096, surfaces[s].vertices.size())});
  std::vector<std::vector<float>> weight(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    weight[s].assign(surfaces[s].vertices.size(), 0);

  // A few sides at a time limit the memory; each vertex sums them in their order.
  constexpr int batch = 8;
  std::vector<Sky> skies(batch);
  for (int first = 0; first < directions; first += batch) {
    const int count = std::min(batch, directions - first);
    parallel_for(count, threads, [&](std::size_t k) {
      auto& sky = skies[k];
      sky.direction = spread(first + static_cast<int>(k), directions);
      const Eigen::Vector3f u = sky.direction.unitOrthogonal();
      sky.rows << (u / cell_mm).transpose(), (sky.direction.cross(u) / cell_mm).transpose(),
          sky.direction.transpose();
      draw_sky(sky, surfaces, centre);
    });
    parallel_for(runs.size(), threads, [&](std::size_t r) {
      const auto& run = runs[r];
      const auto& surface = surfaces[run.surface];
      for (std::size_t i = run.first; i < run.last; ++i)
        for (int k = 0; k < count; ++k) {
          const auto& sky = skies[k];
          const float cosine = surface.normals[i].dot(sky.direction);
          if (cosine <= 0.03f) continue;
          // Offset from the surface, so that its own slope within a cell does not shade it.
          Eigen::Vector3f q =
              sky.rows * (surface.vertices[i] + 1.2f * cell_mm * surface.normals[i] - centre);
          q.head<2>().array() += 0.5f * map_side;
          float open[layers];
          for (int layer = 0; layer < layers; ++layer)
            open[layer] = (surface.alone | surface.together) >> layer & 1u
                              ? open_fraction(sky.depth[layer], q, 0.5f * cell_mm)
                              : 1.f;
          float alone = cosine, together = cosine;
          for (int layer = 0; layer < layers; ++layer) {
            if (surface.alone >> layer & 1u) alone *= open[layer];
            if (surface.together >> layer & 1u) together *= open[layer];
          }
          result[run.surface].alone[i] += alone;
          result[run.surface].together[i] += together;
          weight[run.surface][i] += cosine;
        }
    });
  }
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (std::size_t i = 0; i < weight[s].size(); ++i) {
      const float w = weight[s][i];
      result[s].alone[i] = w > 0 ? result[s].alone[i] / w : 1;
      result[s].together[i] = w > 0 ? result[s].together[i] / w : 1;
    }
    smooth(result[s].alone, surfaces[s].triangles);
    smooth(result[s].together, surfaces[s].triangles);
  }
  return result;
}

template <class Archive>
void fields(Archive& archive, Occlusion& occlusion) {
  archive(occlusion.alone, occlusion.together);
}

std::vector<Occlusion> stored_occlusion(const std::filesystem::path& cache,
                                        std::span<const OcclusionSurface> surfaces, int directions,
                                        int threads) {
  const ResultCache results(cache, "occlusion");
  std::uint64_t inputs = word_hash(&directions, sizeof directions);
  for (const auto& surface : surfaces) {
    const std::size_t numbers[] = {surface.vertices.size(), surface.triangles.size(),
                                   static_cast<std::size_t>(surface.layer), surface.alone,
                                   surface.together};
    inputs = word_hash(numbers, sizeof numbers, inputs);
    inputs = word_hash(surface.vertices.data(), surface.vertices.size_bytes(), inputs);
    inputs = word_hash(surface.normals.data(), surface.normals.size_bytes(), inputs);
    inputs = word_hash(surface.triangles.data(), surface.triangles.size_bytes(), inputs);
  }
  if (const auto bytes = results.read(inputs)) {
    std::vector<Occlusion> stored;
    ArchiveReader reader(*bytes);
    reader(stored);
    if (reader.complete() && stored.size() == surfaces.size()) return stored;
  }
  auto made = bake_occlusion(surfaces, directions, threads);
  ArchiveWriter writer;
  writer(made);
  results.write(inputs, writer.take());
  return made;
}

}  // namespace condyle
