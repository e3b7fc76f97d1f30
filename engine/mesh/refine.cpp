#include "engine/mesh/refine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
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

/// The edges to halve in one pass, each with its new vertex.
class Middles {
 public:
  explicit Middles(TriMesh& mesh) : mesh_(mesh) {}

  /// Whether the edge had no midpoint yet.
  bool halve(int a, int b) {
    const auto [it, made] =
        vertex_.try_emplace(key_of(a, b), static_cast<int>(mesh_.vertices.size()));
    if (!made) return false;
    mesh_.vertices.push_back(0.5 * (mesh_.vertices[a] + mesh_.vertices[b]));
    if (!mesh_.colors.empty()) mesh_.colors.push_back(0.5f * (mesh_.colors[a] + mesh_.colors[b]));
    return true;
  }
  bool empty() const { return vertex_.empty(); }
  void undo() {
    mesh_.vertices.resize(mesh_.vertices.size() - vertex_.size());
    if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.vertices.size());
  }

  /// The triangles subdivided at their halved edges.
  std::vector<Eigen::Vector3i> divided() const {
    std::vector<Eigen::Vector3i> finer;
    finer.reserve(mesh_.triangles.size());
    for (const auto& t : mesh_.triangles) {
      int m[3], count = 0;
      for (int k = 0; k < 3; ++k) {
        const auto found = vertex_.find(key_of(t[k], t[(k + 1) % 3]));
        m[k] = found == vertex_.end() ? -1 : found->second;
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
    return finer;
  }

 private:
  TriMesh& mesh_;
  std::unordered_map<std::uint64_t, int> vertex_;  // for lookup only, never iterated
};

}  // namespace

TriMesh refine_near(TriMesh mesh, const Eigen::Vector3d& center, double radius_mm, double edge_mm,
                    int max_triangles) {
  assert(radius_mm >= 0 && edge_mm > 0);
  while (true) {
    Middles middles(mesh);
    const auto too_long = [&](int a, int b) {
      const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
      return (p - q).norm() > edge_mm && distance_to_edge(p, q, center) <= radius_mm;
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
        if (too_long(a, b)) {
          middles.halve(a, b);
          any = true;
        }
      }
      if (any || length <= edge_mm) continue;
      // All its edges miss the ball, but the face may intersect it.
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
        if (within) middles.halve(t[longest], t[(longest + 1) % 3]);
      }
    }
    if (middles.empty()) return mesh;
    auto finer = middles.divided();
    if (static_cast<int>(finer.size()) > max_triangles) {
      middles.undo();
      return mesh;
    }
    mesh.triangles = std::move(finer);
  }
}

TriMesh refine(TriMesh mesh, std::vector<double> edge_mm, int max_triangles) {
  assert(edge_mm.size() == mesh.vertices.size());
  while (true) {
    Middles middles(mesh);
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        const double length = (mesh.vertices[a] - mesh.vertices[b]).norm();
        if (length > std::min(edge_mm[a], edge_mm[b]) && middles.halve(a, b))
          edge_mm.push_back(std::max(edge_mm[a], edge_mm[b]));
      }
    if (middles.empty()) return mesh;
    auto finer = middles.divided();
    if (static_cast<int>(finer.size()) > max_triangles) {
      middles.undo();
      return mesh;
    }
    mesh.triangles = std::move(finer);
  }
}

}  // namespace condyle
