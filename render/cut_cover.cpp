#include "render/cut_cover.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace condyle {

std::vector<Eigen::Vector3i> cover_rims(std::span<const Eigen::Vector3i> triangles) {
  struct Way {
    int low, high, along;  // +1: from low to high
    bool operator<(const Way& other) const {
      return low != other.low ? low < other.low : high < other.high;
    }
  };
  std::vector<Way> ways;
  ways.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (a != b) ways.push_back(a < b ? Way{a, b, 1} : Way{b, a, -1});
    }
  std::sort(ways.begin(), ways.end());
  std::vector<Way> rim;  // edges that run more often one way than the other, and by how much
  for (std::size_t i = 0; i < ways.size();) {
    Way sum = {ways[i].low, ways[i].high, 0};
    for (; i < ways.size() && ways[i].low == sum.low && ways[i].high == sum.high; ++i)
      sum.along += ways[i].along;
    if (sum.along != 0) rim.push_back(sum);
  }
  // Rims that share no vertex get fans of their own, from their lowest vertex.
  std::map<int, int> apex;
  const auto root = [&](int v) {
    while (apex.at(v) != v) v = apex.at(v) = apex.at(apex.at(v));
    return v;
  };
  for (const auto& way : rim) {
    apex.try_emplace(way.low, way.low);
    apex.try_emplace(way.high, way.high);
    const int a = root(way.low), b = root(way.high);
    apex[std::max(a, b)] = std::min(a, b);
  }
  std::vector<Eigen::Vector3i> cover;
  for (const auto& way : rim) {
    const int top = root(way.low);
    if (top == way.low || top == way.high) continue;
    for (int n = std::abs(way.along); n > 0; --n)
      cover.push_back(way.along > 0 ? Eigen::Vector3i(top, way.high, way.low)
                                    : Eigen::Vector3i(top, way.low, way.high));
  }
  return cover;
}

}  // namespace condyle
