#include "engine/mesh/rims.h"

#include <algorithm>

#include "engine/mesh/topology.h"

namespace condyle {

std::vector<std::vector<int>> rims_of(const TriMesh& mesh) {
  const EdgeList list = find_edges(mesh);
  std::vector<std::vector<int>> next(mesh.vertices.size());
  for (const auto& edge : list.edges) {
    if (edge.count != 1) continue;
    const bool forward = list.sides[static_cast<std::size_t>(edge.first)].forward;
    next[static_cast<std::size_t>(forward ? edge.high : edge.low)].push_back(forward ? edge.low
                                                                                     : edge.high);
  }
  std::vector<std::vector<int>> rims;
  std::vector<int> walk;
  std::vector<char> on_walk(next.size(), 0);
  for (int start = 0; start < static_cast<int>(next.size()); ++start)
    while (!next[static_cast<std::size_t>(start)].empty()) {
      walk = {start};
      on_walk[static_cast<std::size_t>(start)] = 1;
      for (auto* open = &next[static_cast<std::size_t>(start)]; !open->empty();
           open = &next[static_cast<std::size_t>(walk.back())]) {
        const int to = open->back();
        open->pop_back();
        if (on_walk[static_cast<std::size_t>(to)]) {
          const auto first = std::find(walk.begin(), walk.end(), to);
          if (walk.end() - first > 2) rims.emplace_back(first, walk.end());
          for (auto v = first; v != walk.end(); ++v) on_walk[static_cast<std::size_t>(*v)] = 0;
          walk.erase(first, walk.end());
        }
        walk.push_back(to);
        on_walk[static_cast<std::size_t>(to)] = 1;
      }
      for (const int v : walk) on_walk[static_cast<std::size_t>(v)] = 0;
    }
  return rims;
}

}  // namespace condyle
