#include "render/mesh/vertex_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>

namespace condyle {

void vertex_normals(std::span<const Eigen::Vector3f> vertices,
                    std::span<const Eigen::Vector3i> triangles,
                    std::vector<Eigen::Vector3f>& normals) {
  normals.assign(vertices.size(), Eigen::Vector3f::Zero());
  // Slivers have arbitrary normals: triangles below the typical size are weighted by area alone.
  float square = 0;
  int sampled = 0;
  for (std::size_t i = 0; i < triangles.size(); i += 16, ++sampled)
    square += (vertices[triangles[i][1]] - vertices[triangles[i][0]]).squaredNorm();
  const float typical = sampled ? square / static_cast<float>(sampled) : 0;
  const float least = std::max(typical * typical, 1e-12f);
  for (const auto& t : triangles) {
    const Eigen::Vector3f& a = vertices[t[0]];
    const Eigen::Vector3f ab = vertices[t[1]] - a, ac = vertices[t[2]] - a;
    const Eigen::Vector3f n = ab.cross(ac);
    const float c2 = ab.squaredNorm(), b2 = ac.squaredNorm(), a2 = (ac - ab).squaredNorm();
    normals[t[0]] += n / std::max(b2 * c2, least);
    normals[t[1]] += n / std::max(c2 * a2, least);
    normals[t[2]] += n / std::max(a2 * b2, least);
  }
  for (auto& n : normals) {
    const float length = n.norm();
    n = length > 0 ? Eigen::Vector3f(n / length) : Eigen::Vector3f::UnitZ();
  }
}

std::vector<float> vertex_curvature(std::span<const Eigen::Vector3f> vertices,
                                    std::span<const Eigen::Vector3i> triangles,
                                    std::span<const Eigen::Vector3f> normals) {
  std::vector<float> curvature(vertices.size(), 0), sum(vertices.size(), 0);
  std::vector<int> count(vertices.size(), 0);
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      const float length = (vertices[a] - vertices[b]).norm();
      if (length <= 0) continue;
      const float bend = (normals[a] - normals[b]).norm() / length;
      for (const int v : {a, b}) {
        sum[v] += bend;
        ++count[v];
      }
    }
  for (std::size_t v = 0; v < curvature.size(); ++v)
    curvature[v] = count[v] ? sum[v] / static_cast<float>(count[v]) : 0;
  for (int pass = 0; pass < 2; ++pass) {
    std::fill(sum.begin(), sum.end(), 0.f);
    for (const auto& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        sum[a] += curvature[b];
        sum[b] += curvature[a];
      }
    for (std::size_t v = 0; v < curvature.size(); ++v)
      if (count[v]) curvature[v] = 0.5f * (curvature[v] + sum[v] / static_cast<float>(count[v]));
  }
  return curvature;
}

bool is_closed_surface(std::span<const Eigen::Vector3i> triangles) {
  // Each directed edge adds a hash of its vertex pair and its opposite subtracts it: linear in
  // time, and a 64-bit sum that is zero by chance is negligible.
  std::uint64_t sum = 0;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(t[k]);
      const auto b = static_cast<std::uint32_t>(t[(k + 1) % 3]);
      std::uint64_t h = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
      h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
      h = (h ^ (h >> 27)) * 0x94d049bb133111ebull;
      h ^= h >> 31;
      sum += a < b ? h : ~h + 1;
    }
  return !triangles.empty() && sum == 0;
}

}  // namespace condyle
