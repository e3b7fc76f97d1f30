#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

double area_of(const TriMesh& mesh, int triangle) {
  const auto& t = mesh.triangles[triangle];
  return 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                   .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                   .norm();
}

/// Flips triangles so that those at a shared edge agree, patch by patch; a patch's majority by area
/// stays. Returns the number of edges that still contradict.
int make_consistent(TriMesh& mesh, const EdgeList& list, std::vector<char>& turned) {
  const std::size_t count = mesh.triangles.size();
  struct Neighbour {
    int triangle = -1;
    bool agrees = true;
  };
  std::vector<Neighbour> neighbours(3 * count);
  std::vector<char> used(count, 0);
  for (const auto& edge : list.edges) {
    if (edge.count != 2) continue;
    const EdgeSide a = list.sides[edge.first], b = list.sides[edge.first + 1];
    const bool agrees = a.forward != b.forward;
    neighbours[3 * a.triangle + used[a.triangle]++] = {b.triangle, agrees};
    neighbours[3 * b.triangle + used[b.triangle]++] = {a.triangle, agrees};
  }
  turned.assign(count, 0);
  std::vector<char> seen(count, 0);
  int contradictions = 0;
  for (std::size_t seed = 0; seed < count; ++seed) {
    if (seen[seed]) continue;
    std::vector<int> patch = {static_cast<int>(seed)};
    seen[seed] = 1;
    double kept_area = 0, turned_area = 0;
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const int t = patch[next];
      (turned[t] ? turned_area : kept_area) += area_of(mesh, t);
      for (int k = 0; k < used[t]; ++k) {
        const auto [n, agrees] = neighbours[3 * t + k];
        const char consistent = agrees ? turned[t] : !turned[t];
        if (!seen[n]) {
          seen[n] = 1;
          turned[n] = consistent;
          patch.push_back(n);
        } else if (turned[n] != consistent && t < n) {
          ++contradictions;
        }
      }
    }
    if (turned_area > kept_area)
      for (const int t : patch) turned[t] = !turned[t];
  }
  for (std::size_t t = 0; t < count; ++t)
    if (turned[t]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return contradictions;
}

struct Shell {
  TriMesh mesh;  // shares the vertex numbering of the whole only through `source`
  std::vector<int> source;
  double volume = 0;
  Box box;
  bool closed = false;
};

std::vector<Shell> shells_of(const TriMesh& mesh) {
  const Components parts = find_components(mesh);
  std::vector<Shell> shells(parts.count);
  std::vector<int> local(mesh.vertices.size(), -1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Shell& shell = shells[parts.of_triangle[i]];
    Eigen::Vector3i t = mesh.triangles[i];
    for (int k = 0; k < 3; ++k) {
      int& l = local[t[k]];
      if (l < 0) {
        l = static_cast<int>(shell.mesh.vertices.size());
        shell.mesh.vertices.push_back(mesh.vertices[t[k]]);
        shell.box.add(mesh.vertices[t[k]]);
      }
      t[k] = l;
    }
    shell.mesh.triangles.push_back(t);
    shell.source.push_back(static_cast<int>(i));
  }
  for (auto& shell : shells) {
    shell.volume = signed_volume(shell.mesh);
    shell.closed = inspect(shell.mesh).closed();
  }
  return shells;
}

/// Finds the closed shell that contains another. Only the largest shells are tested: a scan may
/// have thousands of specks, which contain nothing.
class Containers {
 public:
  explicit Containers(const std::vector<Shell>& shells) : shells_(shells) {
    for (std::size_t i = 0; i < shells.size(); ++i)
      if (shells[i].closed) largest_.push_back(static_cast<int>(i));
    std::stable_sort(largest_.begin(), largest_.end(), [&](int a, int b) {
      return std::abs(shells[a].volume) > std::abs(shells[b].volume);
    });
    if (largest_.size() > 64) largest_.resize(64);
    trees_.resize(largest_.size());
  }

  /// The largest shell that contains all of `inner`, -1 when there is none.
  int of(int inner) {
    const Shell& shell = shells_[inner];
    for (std::size_t i = 0; i < largest_.size(); ++i) {
      const Shell& outer = shells_[largest_[i]];
      if (std::abs(outer.volume) <= std::abs(shell.volume)) break;
      if (!outer.box.contains(shell.box.low) || !outer.box.contains(shell.box.high)) continue;
      if (!trees_[i]) trees_[i] = std::make_unique<TriangleTree>(outer.mesh);
      // A few vertices suffice: shells that cross are not nested.
      const auto& vertices = shell.mesh.vertices;
      bool inside = true;
      for (std::size_t v = 0; v < vertices.size() && inside; v += 1 + vertices.size() / 16)
        inside = std::abs(trees_[i]->winding_number(vertices[v])) > 0.5;
      if (inside) return largest_[i];
    }
    return -1;
  }

 private:
  const std::vector<Shell>& shells_;
  std::vector<int> largest_;
  std::vector<std::unique_ptr<TriangleTree>> trees_;
};

}  // namespace

Orientation orient_outward(TriMesh& mesh) {
  Orientation result;
  std::vector<char> turned;
  result.contradictions = make_consistent(mesh, find_edges(mesh), turned);

  const std::vector<Shell> shells = shells_of(mesh);
  Containers containers(shells);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (!shells[s].closed) continue;
    const int container = containers.of(static_cast<int>(s));
    const double decides = container >= 0 ? shells[container].volume : shells[s].volume;
    if (decides >= 0) continue;
    if (container < 0) ++result.inward_closed;
    for (const int t : shells[s].source) {
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      turned[t] = !turned[t];
    }
  }
  for (const char t : turned) result.turned += t;
  return result;
}

}  // namespace condyle
