#include "engine/mesh/repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// Open-addressing table of vertices by cell; for lookup only, so its order affects no result.
class CellTable {
 public:
  using Key = std::array<double, 3>;

  explicit CellTable(std::size_t count)
      : slots_(std::bit_ceil(2 * count + 16), -1), keys_(), next_() {
    keys_.reserve(count);
    next_.reserve(count);
    vertices_.reserve(count);
  }
  /// First entry of the cell, -1 when there is none; follow with `next`.
  int find(const Key& key) const { return slots_[slot(key)]; }
  int next(int entry) const { return next_[entry]; }
  int vertex(int entry) const { return vertices_[entry]; }
  void add(const Key& key, int vertex) {
    int& head = slots_[slot(key)];
    keys_.push_back(key);
    next_.push_back(head);
    vertices_.push_back(vertex);
    head = static_cast<int>(vertices_.size()) - 1;
  }

 private:
  std::size_t slot(const Key& key) const {
    std::uint64_t h = 0;
    for (const double k : key) {
      h = (h ^ std::bit_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15ull;
      h ^= h >> 29;
    }
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = static_cast<std::size_t>(h) & mask;
    while (slots_[i] >= 0 && keys_[slots_[i]] != key) i = (i + 1) & mask;
    return i;
  }
  std::vector<int> slots_;
  std::vector<Key> keys_;
  std::vector<int> next_, vertices_;
};

void keep_vertices(TriMesh& mesh, const std::vector<int>& new_index) {
  // new_index is -1 for removed vertices, else increasing.
  const bool colored = mesh.colors.size() == mesh.vertices.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] < 0) continue;
    mesh.vertices[kept] = mesh.vertices[i];
    if (colored) mesh.colors[kept] = mesh.colors[i];
    ++kept;
  }
  mesh.vertices.resize(kept);
  if (colored) mesh.colors.resize(kept);
}

bool repeats_corner(const Vector3i& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

bool is_flat(const TriMesh& mesh, const Vector3i& t) {
  const Vector3d u = mesh.vertices[t[1]] - mesh.vertices[t[0]],
                 v = mesh.vertices[t[2]] - mesh.vertices[t[0]],
                 w = mesh.vertices[t[2]] - mesh.vertices[t[1]];
  // Height over the longest edge below 1e-9 of that edge: beyond the precision of any scanner's
  // file.
  const double longest = std::max({u.squaredNorm(), v.squaredNorm(), w.squaredNorm()});
  return u.cross(v).norm() <= 1e-9 * longest;
}

std::vector<Edge>::const_iterator find_edge(const EdgeList& list, int a, int b) {
  const std::pair key(std::min(a, b), std::max(a, b));
  const auto found = std::lower_bound(
      list.edges.begin(), list.edges.end(), key,
      [](const Edge& e, const std::pair<int, int>& k) { return std::pair(e.low, e.high) < k; });
  const bool there = found != list.edges.end() && std::pair(found->low, found->high) == key;
  return there ? found : list.edges.end();
}

/// Replaces flat triangle `flat` and the one across its longest edge by two across the other
/// diagonal. False if it does not have exactly one neighbour there or the new pair would be flat
/// too.
bool split_neighbour(TriMesh& mesh, const EdgeList& list, int flat, int neighbour,
                     int apex_corner) {
  const Vector3i t = mesh.triangles[flat];
  const int c = t[apex_corner], a = t[(apex_corner + 1) % 3], b = t[(apex_corner + 2) % 3];
  const Vector3i n = mesh.triangles[neighbour];
  int d = -1;
  for (int k = 0; k < 3; ++k)
    if (n[k] != a && n[k] != b) d = n[k];
  if (d < 0 || d == c) return false;
  bool forward = false;  // the neighbour runs from b to a, as it should
  for (int k = 0; k < 3; ++k) forward |= n[k] == b && n[(k + 1) % 3] == a;
  if (!forward) return false;
  const Vector3i one(c, a, d), two(b, c, d);
  if (find_edge(list, c, d) != list.edges.end()) return false;
  if (is_flat(mesh, one) || is_flat(mesh, two)) return false;
  mesh.triangles[flat] = one;
  mesh.triangles[neighbour] = two;
  return true;
}

}  // namespace

int weld(TriMesh& mesh, double tolerance_mm) {
  assert(tolerance_mm >= 0);
  const std::size_t count = mesh.vertices.size();
  std::vector<int> first(count), new_index(count, -1);
  CellTable table(count);
  const double cell = tolerance_mm;
  int kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d& v = mesh.vertices[i];
    CellTable::Key home;
    // Adding 0.0 turns -0.0 into 0.0: both are the same position.
    for (int k = 0; k < 3; ++k) home[k] = (cell > 0 ? std::floor(v[k] / cell) : v[k]) + 0.0;
    int found = -1;
    if (cell > 0) {
      for (int n = 0; n < 27; ++n) {
        const CellTable::Key key = {home[0] + n / 9 - 1, home[1] + n / 3 % 3 - 1,
                                    home[2] + n % 3 - 1};
        for (int e = table.find(key); e >= 0; e = table.next(e)) {
          const int j = table.vertex(e);
          if ((found < 0 || j < found) &&
              (mesh.vertices[j] - v).squaredNorm() <= tolerance_mm * tolerance_mm)
            found = j;
        }
      }
    } else if (const int e = table.find(home); e >= 0) {
      found = table.vertex(e);
    }
    if (found < 0) {
      found = static_cast<int>(i);
      table.add(home, found);
      new_index[i] = kept++;
    }
    first[i] = found;
  }
  if (static_cast<std::size_t>(kept) == count) return 0;
  for (auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) t[k] = new_index[first[t[k]]];
  keep_vertices(mesh, new_index);
  return static_cast<int>(count) - kept;
}

int drop_degenerate(TriMesh& mesh) {
  const std::size_t before = mesh.triangles.size();
  std::erase_if(mesh.triangles, repeats_corner);

  // A flat triangle is merged into its neighbour, which may be flat too: hence a few rounds.
  for (int round = 0; round < 8; ++round) {
    std::vector<int> flat;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      if (is_flat(mesh, mesh.triangles[i])) flat.push_back(static_cast<int>(i));
    if (flat.empty()) break;
    const EdgeList list = find_edges(mesh);
    std::vector<char> touched(mesh.triangles.size(), 0);
    bool changed = false;
    for (const int i : flat) {
      const Vector3i t = mesh.triangles[i];
      int apex = 0;
      double longest = -1;
      for (int k = 0; k < 3; ++k) {
        const double d =
            (mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[(k + 2) % 3]]).squaredNorm();
        if (d > longest) longest = d, apex = k;
      }
      const auto edge = find_edge(list, t[(apex + 1) % 3], t[(apex + 2) % 3]);
      if (edge == list.edges.end() || edge->count != 2) continue;
      const int one = list.sides[edge->first].triangle, two = list.sides[edge->first + 1].triangle;
      const int neighbour = one == i ? two : one;
      if (touched[i] || touched[neighbour]) continue;
      if (split_neighbour(mesh, list, i, neighbour, apex))
        touched[i] = touched[neighbour] = 1, changed = true;
    }
    if (!changed) break;
  }
  std::erase_if(mesh.triangles, [&](const Vector3i& t) { return is_flat(mesh, t); });
  return static_cast<int>(before - mesh.triangles.size());
}

int drop_duplicates(TriMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::array<int, 4>> keys(count);
  for (std::size_t i = 0; i < count; ++i) {
    auto& key = keys[i];
    for (int k = 0; k < 3; ++k) key[k] = mesh.triangles[i][k];
    std::sort(key.begin(), key.begin() + 3);
    key[3] = static_cast<int>(i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<char> gone(count, 0);
  for (std::size_t i = 1; i < count; ++i)
    if (std::equal(keys[i].begin(), keys[i].begin() + 3, keys[i - 1].begin())) gone[keys[i][3]] = 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (!gone[i]) mesh.triangles[kept++] = mesh.triangles[i];
  mesh.triangles.resize(kept);
  return static_cast<int>(count - kept);
}

int drop_unreferenced(TriMesh& mesh) {
  std::vector<int> new_index(mesh.vertices.size(), -1);
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) new_index[t[k]] = 0;
  int kept = 0;
  for (auto& n : new_index)
    if (n == 0) n = kept++;
  const int gone = static_cast<int>(new_index.size()) - kept;
  if (gone == 0) return 0;
  for (auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) t[k] = new_index[t[k]];
  keep_vertices(mesh, new_index);
  return gone;
}

void flip(TriMesh& mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

}  // namespace condyle
