#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace condyle {

/// An order to eliminate the vertices of a graph in, with little fill, in three parts: places
/// [part[0], part[1]) and [part[1], part[2]) contact each other only through [part[2], part[3]), so
/// that two threads can work on them.
struct EliminationOrder {
  std::vector<int> at;  // place -> vertex
  std::array<int, 4> part{};
};

/// `ring`: the neighbours of each vertex, ascending, without itself; symmetric. `position`, mm: the
/// graph is bisected along the longest side of its box; each half is in minimum degree order.
EliminationOrder elimination_order(const std::vector<std::vector<int>>& ring,
                                   const std::vector<Eigen::Vector3d>& position);

}  // namespace condyle
