#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace condyle {

/// Directed edges of which opposite ones cancel.
class CapEdges {
 public:
  void add(int from, int to);
  /// The edges that are left, sorted; an edge that is left n times, n times.
  std::vector<std::pair<int, int>> remaining() const;

 private:
  std::unordered_map<std::uint64_t, int> balance_;  // traversals from low to high less the others
};

struct CapLoops {
  std::vector<int> vertices;            // of the cap
  std::vector<Eigen::Vector2d> points;  // one per vertex, in the cap's plane
  std::vector<std::vector<int>> loops;  // indices of points
};

/// Joins the edges end to end. Where several leave a vertex, the leftmost is taken, so that loops
/// do not cross at it. `right` and `up` span the plane.
CapLoops find_cap_loops(const CapEdges& edges, const std::vector<Eigen::Vector3d>& vertices,
                        const Eigen::Vector3d& right, const Eigen::Vector3d& up);

}  // namespace condyle
