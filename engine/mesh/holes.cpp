#include "engine/mesh/holes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/mesh/pieces.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

constexpr std::size_t max_edges = 64;
constexpr int none = -1;
constexpr double hole_fraction = 0.25;  // of its piece's area, at most

/// The edges with one triangle, each with its successor along the rim.
class Rims {
 public:
  explicit Rims(const TriMesh& mesh) : mesh_(mesh) {
    const EdgeList list = find_edges(mesh);
    across_.assign(3 * mesh.triangles.size(), none);
    std::vector<char> knotted(across_.size(), 0);
    for (const auto& edge : list.edges) {
      edges_.emplace_back(edge.low, edge.high);
      const auto half = [&](int k) {
        const int t = list.sides[edge.first + k].triangle;
        const int from = list.sides[edge.first + k].forward ? edge.low : edge.high;
        const auto& corners = mesh.triangles[t];
        return 3 * t + (corners[0] == from ? 0 : corners[1] == from ? 1 : 2);
      };
      if (edge.count == 2 && list.sides[edge.first].forward != list.sides[edge.first + 1].forward) {
        across_[half(0)] = half(1);
        across_[half(1)] = half(0);
      } else if (edge.count != 1) {
        for (int k = 0; k < edge.count; ++k) knotted[half(k)] = 1;
      }
    }
    next_.assign(across_.size(), none);
    for (int h = 0; h < static_cast<int>(across_.size()); ++h)
      if (across_[h] == none && !knotted[h]) next_[h] = following(h, knotted);
  }

  /// Vertices of each hole in the order of its new triangles, opposite to the rim's own.
  std::vector<std::vector<int>> holes() const {
    std::vector<std::vector<int>> found;
    std::vector<char> seen(next_.size(), 0);
    for (int start = 0; start < static_cast<int>(next_.size()); ++start) {
      if (next_[start] == none || seen[start]) continue;
      std::vector<int> walk;
      int h = start;
      while (h != none && !seen[h]) {
        seen[h] = 1;
        walk.push_back(mesh_.triangles[h / 3][h % 3]);
        h = next_[h];
      }
      if (h == start) part(std::move(walk), found);
    }
    for (auto& hole : found) std::reverse(hole.begin(), hole.end());
    return found;
  }

  bool joined(int a, int b) const {
    return std::binary_search(edges_.begin(), edges_.end(), std::minmax(a, b),
                              [](const auto& x, const auto& y) {
                                return std::pair<int, int>(x) < std::pair<int, int>(y);
                              });
  }

 private:
  static int next_in_triangle(int h) { return h % 3 == 2 ? h - 2 : h + 1; }

  /// The rim's edge after `h`, found through the triangles around its end.
  int following(int h, const std::vector<char>& knotted) const {
    int at = next_in_triangle(h);
    for (std::size_t turn = 0; turn < across_.size(); ++turn) {
      if (knotted[at]) return none;
      if (across_[at] == none) return at;
      at = next_in_triangle(across_[at]);
    }
    return none;
  }

  /// A walk that meets a vertex again has closed a separate hole in between.
  static void part(std::vector<int> walk, std::vector<std::vector<int>>& found) {
    std::vector<int> open;
    for (const int v : walk) {
      if (const auto again = std::find(open.begin(), open.end(), v); again != open.end()) {
        found.emplace_back(again, open.end());
        open.erase(again, open.end());
      }
      open.push_back(v);
    }
    found.push_back(std::move(open));
  }

  const TriMesh& mesh_;
  std::vector<int> across_, next_;  // by half edge: three times the triangle, plus the corner
  std::vector<std::pair<int, int>> edges_;
};

double rim_length(const TriMesh& mesh, const std::vector<int>& hole) {
  double length = 0;
  for (std::size_t i = 0; i < hole.size(); ++i)
    length += (mesh.vertices[hole[i]] - mesh.vertices[hole[(i + 1) % hole.size()]]).norm();
  return length;
}

/// The triangulation of least area of the polygon, if one exists that uses no edge of the mesh and
/// has at most `max_area`.
std::optional<std::vector<Eigen::Vector3i>> cover(const TriMesh& mesh, const Rims& rims,
                                                  const std::vector<int>& hole, double max_area) {
  const int n = static_cast<int>(hole.size());
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<double> least(static_cast<std::size_t>(n) * n, 0);
  std::vector<int> corner(least.size(), none);
  const auto at = [n](int i, int j) { return static_cast<std::size_t>(i) * n + j; };
  const auto area = [&](int i, int k, int j) {
    const auto& a = mesh.vertices[hole[i]];
    return 0.5 * (mesh.vertices[hole[k]] - a).cross(mesh.vertices[hole[j]] - a).norm();
  };
  for (int span = 2; span < n; ++span)
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      least[at(i, j)] = never;
      if (span < n - 1 && rims.joined(hole[i], hole[j])) continue;
      for (int k = i + 1; k < j; ++k) {
        const double sum = least[at(i, k)] + least[at(k, j)] + area(i, k, j);
        if (sum < least[at(i, j)]) {
          least[at(i, j)] = sum;
          corner[at(i, j)] = k;
        }
      }
    }
  if (!(least[at(0, n - 1)] <= max_area)) return std::nullopt;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<std::pair<int, int>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = corner[at(i, j)];
    triangles.emplace_back(hole[i], hole[k], hole[j]);
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
  return triangles;
}

}  // namespace

ClosedHoles close_small_holes(TriMesh& mesh, const SmallHole& small) {
  const Rims rims(mesh);
  const Components pieces = find_components(mesh);
  const std::vector<double> area = component_areas(mesh, pieces);
  std::vector<int> piece_of(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t]) piece_of[v] = pieces.of_triangle[t];
  ClosedHoles closed;
  std::vector<Eigen::Vector3i> added;
  for (const auto& hole : rims.holes()) {
    if (hole.size() < 3 || hole.size() > max_edges) continue;
    const double length = rim_length(mesh, hole);
    const bool few = hole.size() <= static_cast<std::size_t>(small.few_edges);
    if (length > small.rim_mm && !(few && length <= small.few_edges_rim_mm)) continue;
    // The outer rim of a small loose sheet is not a hole.
    const auto triangles = cover(mesh, rims, hole, hole_fraction * area[piece_of[hole[0]]]);
    if (!triangles) continue;
    added.insert(added.end(), triangles->begin(), triangles->end());
    ++closed.holes;
    closed.longest_rim_mm = std::max(closed.longest_rim_mm, length);
  }
  mesh.triangles.insert(mesh.triangles.end(), added.begin(), added.end());
  return closed;
}

}  // namespace condyle
