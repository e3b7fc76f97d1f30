#include "engine/mesh/rims.h"

#include "engine/mesh/topology.h"

namespace condyle {

std::vector<std::vector<int>> rims_of(const TriMesh& mesh) {
  const EdgeList list = find_edges(mesh);
  std::vector<int> next(mesh.vertices.size(), -1);
  for (const auto& edge : list.edges) {
    if (edge.count != 1) continue;
    const bool forward = list.sides[static_cast<std::size_t>(edge.first)].forward;
    next[static_cast<std::size_t>(forward ? edge.high : edge.low)] = forward ? edge.low : edge.high;
  }
  std::vector<std::vector<int>> rims;
  std::vector<char> seen(next.size(), 0);
  for (int start = 0; start < static_cast<int>(next.size()); ++start) {
    std::vector<int> walk;
    int at = start;
    for (; at >= 0 && !seen[static_cast<std::size_t>(at)];
         at = next[static_cast<std::size_t>(at)]) {
      seen[static_cast<std::size_t>(at)] = 1;
      if (next[static_cast<std::size_t>(at)] >= 0) walk.push_back(at);
    }
    if (at == start && walk.size() > 2) rims.push_back(std::move(walk));
  }
  return rims;
}

}  // namespace condyle
