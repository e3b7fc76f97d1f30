#include "engine/mesh/refine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace condyle {
namespace {

double distance_to_edge(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& p) {
  const Eigen::Vector3d along = b - a;
  const double s = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return (a + s * along - p).norm();
}

std::uint64_t key_of(int a, int b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
         static_cast<std::uint32_t>(std::max(a, b));
}

}  // namespace

TriMesh refine_near(TriMesh mesh, const Eigen::Vector3d& center, double radius_mm, double edge_mm,
                    int most_triangles) {
  for (bool divided = true; divided;) {
    divided = false;
    std::unordered_map<std::uint64_t, int> middles;  // looked up only, never walked
    std::vector<Eigen::Vector3i> finer;
    finer.reserve(mesh.triangles.size());
    const auto wanted = [&](int a, int b) {
      const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
      return (p - q).norm() > edge_mm && distance_to_edge(p, q, center) <= radius_mm;
    };
    const auto halve = [&](int a, int b) {
      const auto [it, made] =
          middles.try_emplace(key_of(a, b), static_cast<int>(mesh.vertices.size()));
      if (!made) return;
      mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
      if (!mesh.colors.empty()) mesh.colors.push_back(0.5f * (mesh.colors[a] + mesh.colors[b]));
    };
    for (const auto& t : mesh.triangles) {
      int longest = 0;
      double length = 0;
      bool any = false;
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (const double l = (mesh.vertices[a] - mesh.vertices[b]).norm(); l > length) {
          length = l;
          longest = k;
        }
        if (wanted(a, b)) {
          halve(a, b);
          any = true;
        }
      }
      if (any || length <= edge_mm) continue;
      // Its edges all pass by the ball, but the face may go through it.
      const Eigen::Vector3d middle =
          (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
      if ((middle - center).norm() <= radius_mm + length) {
        const Eigen::Vector3d n = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                      .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                                      .normalized();
        const double height = n.dot(center - mesh.vertices[t[0]]);
        const Eigen::Vector3d foot = center - height * n;
        bool within = std::abs(height) < radius_mm;
        for (int k = 0; k < 3 && within; ++k)
          within = n.dot((mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]])
                             .cross(foot - mesh.vertices[t[k]])) >= 0;
        if (within) halve(t[longest], t[(longest + 1) % 3]);
      }
    }
    if (middles.empty()) break;
    for (const auto& t : mesh.triangles) {
      int m[3], count = 0;
      for (int k = 0; k < 3; ++k) {
        const auto found = middles.find(key_of(t[k], t[(k + 1) % 3]));
        m[k] = found == middles.end() ? -1 : found->second;
        count += m[k] >= 0;
      }
      if (count == 0) {
        finer.push_back(t);
      } else if (count == 3) {
        finer.insert(
            finer.end(),
            {{t[0], m[0], m[2]}, {m[0], t[1], m[1]}, {m[2], m[1], t[2]}, {m[0], m[1], m[2]}});
      } else {
        // Turned so that edge 0 is divided, and with two divided edges, edge 2 is not.
        int k = 0;
        while (m[k] < 0 || (count == 2 && m[(k + 2) % 3] >= 0)) ++k;
        const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3];
        finer.push_back({ab, b, count == 2 ? bc : c});
        if (count == 2) finer.push_back({ab, bc, c});
        finer.push_back({a, ab, c});
      }
    }
    if (static_cast<int>(finer.size()) > most_triangles) break;
    mesh.triangles = std::move(finer);
    divided = true;
  }
  return mesh;
}

}  // namespace condyle
