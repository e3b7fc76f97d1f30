#include "engine/cut/cap_loops.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "engine/cut/edge_key.h"

namespace condyle {

void CapEdges::add(int from, int to) { balance_[edge_key(from, to)] += from < to ? 1 : -1; }

std::vector<std::pair<int, int>> CapEdges::remaining() const {
  std::vector<std::pair<int, int>> edges;
  for (const auto& [key, balance] : balance_)
    for (int i = 0; i < std::abs(balance); ++i)
      edges.push_back(balance > 0 ? std::pair(low_vertex(key), high_vertex(key))
                                  : std::pair(high_vertex(key), low_vertex(key)));
  std::sort(edges.begin(), edges.end());
  return edges;
}

CapLoops find_cap_loops(const CapEdges& edges, const std::vector<Eigen::Vector3d>& vertices,
                        const Eigen::Vector3d& right, const Eigen::Vector3d& up) {
  CapLoops cap;
  std::unordered_map<int, int> numbers;
  const auto number = [&](int vertex) {
    const auto [at, is_new] = numbers.try_emplace(vertex, static_cast<int>(cap.vertices.size()));
    if (is_new) {
      cap.vertices.push_back(vertex);
      cap.points.push_back({right.dot(vertices[vertex]), up.dot(vertices[vertex])});
    }
    return at->second;
  };
  std::map<int, std::vector<int>> leaving;
  for (const auto& [from, to] : edges.remaining()) leaving[number(from)].push_back(number(to));
  const auto leftmost = [&](int previous, int at, const std::vector<int>& ends) {
    if (ends.size() == 1 || previous < 0) return std::size_t{0};
    const Eigen::Vector2d arrival = cap.points[at] - cap.points[previous];
    std::size_t best = 0;
    double best_angle = -10;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const Eigen::Vector2d step = cap.points[ends[i]] - cap.points[at];
      const double angle =
          std::atan2(arrival.x() * step.y() - arrival.y() * step.x(), arrival.dot(step));
      if (angle <= best_angle) continue;
      best_angle = angle;
      best = i;
    }
    return best;
  };
  while (!leaving.empty()) {
    const int start = leaving.begin()->first;
    int at = start, previous = -1;
    std::vector<int> loop;
    do {
      const auto ends = leaving.find(at);
      if (ends == leaving.end()) break;  // only where edges are not balanced
      const std::size_t pick = leftmost(previous, at, ends->second);
      const int next = ends->second[pick];
      ends->second.erase(ends->second.begin() + static_cast<std::ptrdiff_t>(pick));
      if (ends->second.empty()) leaving.erase(ends);
      loop.push_back(at);
      previous = at;
      at = next;
    } while (at != start);
    if (at == start) cap.loops.push_back(std::move(loop));
  }
  return cap;
}

}  // namespace condyle
