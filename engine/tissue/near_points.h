#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "engine/tissue/mesh_point.h"

namespace condyle {

/// Bounds kept between contact searches with one obstacle: the distance of each point at its last
/// query and the displacement of the nodes since, relative to the obstacle. Points that cannot have
/// come near are skipped. A value that belongs to a state and to one list of points; it never
/// changes a result.
class NearPoints {
 public:
  /// Sets the present nodes, in obstacle coordinates.
  void moved(const std::vector<MeshPoint>& points, Nodes x);

  /// Calls `query(i)`, which returns a lower bound of the distance (mm), for each point in
  /// ascending order that may be nearer than `reach`.
  template <class Query>
  void each(double reach, const Query& query) {
    for (std::size_t r = 0; r < bound_of_run_.size(); ++r) {
      const double path = path_of_run(r);
      if (bound_of_run_[r] - path > reach) continue;
      double least = far_mm;
      for (int i = runs_->point[r]; i < runs_->point[r + 1]; ++i) {
        double& here = bound_[i];
        here -= path;
        if (here <= reach) here = std::min(query(i), far_mm);
        least = std::min(least, here);
      }
      bound_of_run_[r] = least;
      seen(r);
    }
  }

 private:
  /// Ranges of consecutive points, and their nodes.
  struct Runs {
    std::vector<int> point, first_node, node;
    explicit Runs(const std::vector<MeshPoint>& points);
  };
  static constexpr double far_mm = 1e6;
  double path_of_run(std::size_t run) const;
  void seen(std::size_t run);

  std::shared_ptr<const Runs> runs_;
  Nodes last_;
  std::vector<double> path_;       // path length of each node so far, mm
  std::vector<double> path_then_;  // of each range's nodes, at the last query of its points
  std::vector<double> bound_;      // lower bound per point at its last query
  std::vector<double> bound_of_run_;
};

}  // namespace condyle
