#include "render/mesh/cut_cover.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace condyle {

std::vector<Eigen::Vector3i> cover_rims(std::span<const Eigen::Vector3i> triangles) {
  struct DirectedEdge {
    int low, high, along;  // +1: from low to high
    bool operator<(const DirectedEdge& other) const {
      return low != other.low ? low < other.low : high < other.high;
    }
  };
  std::vector<DirectedEdge> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (a != b) edges.push_back(a < b ? DirectedEdge{a, b, 1} : DirectedEdge{b, a, -1});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<DirectedEdge>
      rim;  // edges with more uses in one direction than in the other, and the surplus
  for (std::size_t i = 0; i < edges.size();) {
    DirectedEdge sum = {edges[i].low, edges[i].high, 0};
    for (; i < edges.size() && edges[i].low == sum.low && edges[i].high == sum.high; ++i)
      sum.along += edges[i].along;
    if (sum.along != 0) rim.push_back(sum);
  }
  // Rims without a common vertex get separate fans, from their lowest vertex.
  std::map<int, int> apex;
  const auto root = [&](int v) {
    while (apex.at(v) != v) v = apex.at(v) = apex.at(apex.at(v));
    return v;
  };
  for (const auto& edge : rim) {
    apex.try_emplace(edge.low, edge.low);
    apex.try_emplace(edge.high, edge.high);
    const int a = root(edge.low), b = root(edge.high);
    apex[std::max(a, b)] = std::min(a, b);
  }
  std::vector<Eigen::Vector3i> cover;
  for (const auto& edge : rim) {
    const int top = root(edge.low);
    if (top == edge.low || top == edge.high) continue;
    for (int n = std::abs(edge.along); n > 0; --n)
      cover.push_back(edge.along > 0 ? Eigen::Vector3i(top, edge.high, edge.low)
                                     : Eigen::Vector3i(top, edge.low, edge.high));
  }
  return cover;
}

}  // namespace condyle
