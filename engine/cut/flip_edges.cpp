#include "engine/cut/flip_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>

#include "engine/cut/edge_key.h"
#include "engine/cut/plane_geometry.h"

namespace condyle {
namespace {

class Flipper {
 public:
  Flipper(std::span<const Eigen::Vector2d> points, std::vector<Eigen::Vector3i>& triangles)
      : points_(points), triangles_(triangles) {
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
      for (int k = 0; k < 3; ++k) add(t, triangles[t][k], triangles[t][(k + 1) % 3]);
    for (const auto& [key, at] : edges_)
      if (at[0] >= 0 && at[1] >= 0) waiting_.push_back(key);
    std::sort(waiting_.begin(), waiting_.end());
  }

  void run() {
    // Overlapping triangles of crossing loops could flip for ever.
    const std::size_t limit = 40 * waiting_.size() + 100;
    for (std::size_t i = 0; i < waiting_.size() && i < limit; ++i) improve(waiting_[i]);
  }

 private:
  using Triangles = std::array<int, 2>;  // at an edge; -1: none, -2: more than two
  static constexpr int none = -1, several = -2;

  void add(int triangle, int a, int b) {
    Triangles& at = edges_.try_emplace(edge_key(a, b), Triangles{none, none}).first->second;
    if (at[0] == none)
      at[0] = triangle;
    else if (at[1] == none)
      at[1] = triangle;
    else
      at = {several, several};
  }

  bool runs(int triangle, int a, int b) const {
    for (int k = 0; k < 3; ++k)
      if (triangles_[triangle][k] == a && triangles_[triangle][(k + 1) % 3] == b) return true;
    return false;
  }
  int opposite(int triangle, int a, int b) const {
    for (const int v : triangles_[triangle])
      if (v != a && v != b) return v;
    return none;
  }
  double angle(int at, int a, int b) const {
    const Eigen::Vector2d u = points_[a] - points_[at], v = points_[b] - points_[at];
    return std::atan2(std::abs(u.x() * v.y() - u.y() * v.x()), u.dot(v));
  }

  void improve(std::uint64_t key) {
    const auto found = edges_.find(key);
    if (found == edges_.end() || found->second[0] < 0 || found->second[1] < 0) return;
    const int a = low_vertex(key), c = high_vertex(key);
    auto [first, second] = found->second;
    if (!runs(first, a, c)) std::swap(first, second);
    if (!runs(first, a, c) || !runs(second, c, a)) return;
    const int b = opposite(first, a, c), d = opposite(second, a, c);
    if (b < 0 || d < 0 || b == d) return;
    const auto diagonal = edges_.find(edge_key(b, d));
    if (diagonal != edges_.end() && diagonal->second[0] != none) return;
    if (angle(b, a, c) + angle(d, a, c) <= std::numbers::pi + 1e-9) return;
    const double least = 1e-12 * (points_[b] - points_[d]).squaredNorm();
    if (double_area(points_[a], points_[d], points_[b]) <= least ||
        double_area(points_[d], points_[c], points_[b]) <= least)
      return;
    edges_.erase(found);
    triangles_[first] = {a, d, b};
    triangles_[second] = {d, c, b};
    edges_[edge_key(b, d)] = {first, second};
    replace(a, d, second, first);
    replace(d, c, second, second);
    replace(c, b, first, second);
    replace(b, a, first, first);
  }

  void replace(int a, int b, int old, int triangle) {
    const auto found = edges_.find(edge_key(a, b));
    if (found == edges_.end()) return;
    for (int& t : found->second)
      if (t == old) {
        t = triangle;
        break;
      }
    if (found->second[0] >= 0 && found->second[1] >= 0) waiting_.push_back(found->first);
  }

  std::span<const Eigen::Vector2d> points_;
  std::vector<Eigen::Vector3i>& triangles_;
  std::unordered_map<std::uint64_t, Triangles> edges_;
  std::vector<std::uint64_t> waiting_;
};

}  // namespace

void flip_edges(std::span<const Eigen::Vector2d> points, std::vector<Eigen::Vector3i>& triangles) {
  Flipper(points, triangles).run();
}

}  // namespace condyle
