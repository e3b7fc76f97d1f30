#pragma once

#include <algorithm>
#include <cstdint>

namespace condyle {

/// Number of an undirected edge, in the order of its lower vertex.
inline std::uint64_t edge_key(int a, int b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
         static_cast<std::uint32_t>(std::max(a, b));
}
inline int low_vertex(std::uint64_t key) { return static_cast<int>(key >> 32); }
inline int high_vertex(std::uint64_t key) {
  return static_cast<int>(static_cast<std::uint32_t>(key));
}

}  // namespace condyle
