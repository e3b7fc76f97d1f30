#include "sim/tissue/lip_pocket.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <set>

#include "engine/core/infinity.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double deep_mm = 5;  // behind the line, in the middle of the mouth: a pocket
constexpr double middle_mm = 8;
constexpr double high_mm = 12, beside_mm = 3, back_mm = 30;  // about the line: where it may lie
constexpr double steep_mm = 3;                               // so much deeper, a way costs a third
constexpr double level_mm = 4;  // so far above or below the line, twice as much

}  // namespace

std::vector<int> pocket_bottom(const TriMesh& face, const Vector3d& right, const Vector3d& middle,
                               const Vector3d& left) {
  const auto height = [&](const Vector3d& p) {
    const Vector3d& a = p.x() < middle.x() ? right : middle;
    const Vector3d& b = p.x() < middle.x() ? middle : left;
    return p.z() - (a.z() + (p.x() - a.x()) / (b.x() - a.x()) * (b.z() - a.z()));
  };
  const auto depth = [&](int v) { return face.vertices[v].y() - middle.y(); };
  std::map<int, std::vector<int>> near;  // the vertices about the line and their neighbours
  bool pocket = false;
  for (const auto& t : face.triangles) {
    bool inside = true;
    for (int v : t) {
      const Vector3d& p = face.vertices[v];
      inside = inside && p.x() > right.x() - beside_mm && p.x() < left.x() + beside_mm &&
               std::abs(height(p)) < high_mm && depth(v) < back_mm;
      pocket = pocket || (inside && std::abs(p.x() - middle.x()) < middle_mm &&
                          depth(v) > deep_mm && std::abs(height(p)) < high_mm / 2);
    }
    if (!inside) continue;
    for (int k = 0; k < 3; ++k) {
      near[t[k]].push_back(t[(k + 1) % 3]);
      near[t[(k + 1) % 3]].push_back(t[k]);
    }
  }
  if (!pocket) return {};
  const auto nearest = [&](const Vector3d& p) {
    int best = near.begin()->first;
    for (const auto& [v, _] : near)
      if ((face.vertices[v] - p).squaredNorm() < (face.vertices[best] - p).squaredNorm()) best = v;
    return best;
  };
  const int from = nearest(right), to = nearest(left);

  std::map<int, double> cost{{from, 0.0}};
  std::map<int, int> before;
  using Waiting = std::pair<double, int>;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting;
  waiting.push({0.0, from});
  while (!waiting.empty() && waiting.top().second != to) {
    const auto [so_far, v] = waiting.top();
    waiting.pop();
    if (so_far > cost[v]) continue;
    for (int n : near[v]) {
      const double off = height(face.vertices[n]) / level_mm;
      const double way = (face.vertices[n] - face.vertices[v]).norm() * (1 + off * off) *
                         std::exp(-0.5 * (depth(v) + depth(n)) / steep_mm);
      const auto known = cost.try_emplace(n, infinity).first;
      if (so_far + way >= known->second) continue;
      known->second = so_far + way;
      before[n] = v;
      waiting.push({known->second, n});
    }
  }
  if (from == to || !before.count(to)) return {};
  std::vector<int> run{to};
  while (run.back() != from) run.push_back(before[run.back()]);
  std::reverse(run.begin(), run.end());
  return run;
}

void cut_along(const std::vector<int>& run, TriMesh& surface) {
  std::map<int, std::vector<int>> around;  // triangles of each vertex of the run
  for (int v : run) around[v];
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int v : surface.triangles[t])
      if (const auto it = around.find(v); it != around.end())
        it->second.push_back(static_cast<int>(t));
  const std::vector<Eigen::Vector3i> whole = surface.triangles;
  const auto has = [&](int t, int a, int b) {  // the directed edge
    for (int k = 0; k < 3; ++k)
      if (whole[t][k] == a && whole[t][(k + 1) % 3] == b) return true;
    return false;
  };
  for (std::size_t i = 1; i + 1 < run.size(); ++i) {
    const int last = run[i - 1], v = run[i], next = run[i + 1];
    // From the triangle to the right of the next edge on, around v, to the edge before.
    std::set<int> right;
    int at = next;
    while (at != last) {
      const auto& fan = around[v];
      const auto found = std::find_if(fan.begin(), fan.end(), [&](int t) { return has(t, at, v); });
      if (found == fan.end() || !right.insert(*found).second) break;
      for (int corner : whole[*found])
        if (corner != v && corner != at) {
          at = corner;
          break;
        }
    }
    const int twin = static_cast<int>(surface.vertices.size());
    const Vector3d place = surface.vertices[v];
    surface.vertices.push_back(place);
    if (!surface.colors.empty()) {
      const Eigen::Vector3f color = surface.colors[v];
      surface.colors.push_back(color);
    }
    for (int t : right)
      for (int& corner : surface.triangles[t])
        if (corner == v) corner = twin;
  }
}

}  // namespace condyle
