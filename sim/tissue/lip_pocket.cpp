#include "sim/tissue/lip_pocket.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <set>

#include "engine/core/infinity.h"
#include "engine/mesh/slit_seam.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// behind the front of the lips, in the middle of the mouth: a pocket
constexpr double deep_mm = 10;
constexpr double middle_mm = 8;
constexpr double high_mm = 12, back_mm = 30;  // around the lip line: the search region
constexpr double corner_mm = 2.5;             // around a corner, where its foremost skin is sought
constexpr double steep_mm = 3;                // so much deeper, a path costs a third
constexpr double level_mm = 4;                // so far above or below the line, twice as much

}  // namespace

std::vector<int> pocket_bottom(const TriMesh& face, const LipLine& line) {
  const auto& [right, middle, left] = line;
  const auto in_zone = [&](int v) {
    const Vector3d& p = face.vertices[v];
    return p.x() > right.x() - corner_mm && p.x() < left.x() + corner_mm &&
           std::abs(line.height(p)) < high_mm && p.y() < middle.y() + back_mm;
  };
  std::set<int> border;
  for (const auto& edge : find_edges(face).edges)
    if (edge.count != 2 && in_zone(edge.low)) border.insert({edge.low, edge.high});
  std::map<int, std::vector<int>> near;  // the vertices around the line and their neighbours
  double front = infinity;               // of the lips in the middle
  for (const auto& t : face.triangles) {
    if (!std::all_of(t.begin(), t.end(), in_zone)) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      const Vector3d& p = face.vertices[a];
      if (std::abs(p.x() - middle.x()) < middle_mm) front = std::min(front, p.y());
      if (border.count(a) || border.count(b)) continue;
      near[a].push_back(b);
      near[b].push_back(a);
    }
  }
  if (near.empty() || front == infinity) return {};
  // The skin, not what may lie behind it.
  const auto corner = [&](const Vector3d& at) {
    const auto off = [&](int v) {
      return std::hypot(face.vertices[v].x() - at.x(), face.vertices[v].z() - at.z());
    };
    double foremost = infinity;
    for (const auto& [v, _] : near)
      if (off(v) < corner_mm) foremost = std::min(foremost, face.vertices[v].y());
    int best = -1;
    for (const auto& [v, _] : near)
      if (face.vertices[v].y() < foremost + corner_mm && off(v) < corner_mm &&
          (best < 0 || off(v) < off(best)))
        best = v;
    return best;
  };
  const int from = corner(right), to = corner(left);
  if (from < 0 || to < 0) return {};
  const double first_x = face.vertices[from].x(), last_x = face.vertices[to].x();

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
      const Vector3d& p = face.vertices[n];
      if (n != to && (p.x() <= first_x || p.x() >= last_x)) continue;  // the ends are the corners
      const double off = line.height(p) / level_mm;
      const double depth = 0.5 * (p.y() + face.vertices[v].y()) - middle.y();
      const double length =
          (p - face.vertices[v]).norm() * (1 + off * off) * std::exp(-depth / steep_mm);
      const auto known = cost.try_emplace(n, infinity).first;
      if (so_far + length >= known->second) continue;
      known->second = so_far + length;
      before[n] = v;
      waiting.push({known->second, n});
    }
  }
  if (from == to || !before.count(to)) return {};
  std::vector<int> run{to};
  while (run.back() != from) run.push_back(before[run.back()]);
  std::reverse(run.begin(), run.end());
  double shallowest = infinity;
  for (int v : run)
    if (std::abs(face.vertices[v].x() - middle.x()) < middle_mm)
      shallowest = std::min(shallowest, face.vertices[v].y());
  return shallowest > front + deep_mm && shallowest < infinity ? run : std::vector<int>{};
}

bool open_pouch(TriMesh& face, const LipLine& line, const std::vector<int>& bottom) {
  constexpr double beside_mm = 70, behind_mm = 100;  // of the middle of the lips: the search region
  constexpr double min_height_mm = 8;                // lower openings are mere gaps
  // The tissue ends at the lips' edge; broader seams, which touch one another, fold in it.
  constexpr SlitSeam seam{.at_ends_mm = 0.5, .at_sides_mm = 10};
  auto kept = without_deep_inside(face, bottom, line.middle, beside_mm, seam);
  if (kept.size() == face.triangles.size()) return false;
  // Both lists have the same order.
  double low = infinity, high = -infinity;
  std::size_t next = 0;
  for (const auto& t : face.triangles) {
    if (next < kept.size() && kept[next] == t) {
      ++next;
      continue;
    }
    for (const int v : t) {
      const Vector3d& p = face.vertices[v];
      if (p.y() > line.middle.y() + behind_mm) return false;
      if (std::abs(p.x() - line.middle.x()) > middle_mm) continue;
      low = std::min(low, p.z());
      high = std::max(high, p.z());
    }
  }
  if (high - low < min_height_mm) return false;
  face.triangles = std::move(kept);
  return true;
}

void cut_along(const std::vector<int>& run, TriMesh& surface) {
  std::map<int, std::vector<int>> around;  // triangles of each vertex of the chain
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
    // Around v, from the triangle to the right of the next edge to the edge before.
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
    const Vector3d position = surface.vertices[v];
    surface.vertices.push_back(position);
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
