#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "engine/tissue/net_point.h"

namespace condyle {

/// What looks at one obstacle learn for the next ones: how near each point was, and how far nodes
/// have gone since, as seen from the obstacle. What cannot have come near is passed over. A value
/// that goes with a state; it serves one list of points, and changes no answer.
class NearPoints {
 public:
  /// The nodes are at x now, in the obstacle's coordinates.
  void moved(const std::vector<NetPoint>& points, Nodes x);

  /// Asks `look(i)`, which gives what the point is no nearer than (mm), for each point, rising,
  /// that may be nearer than `reach`.
  template <class Look>
  void each(double reach, const Look& look) {
    for (std::size_t r = 0; r < least_of_run_.size(); ++r) {
      const double way = way_of_run(r);
      if (least_of_run_[r] - way > reach) continue;
      double least = far_mm;
      for (int i = runs_->point[r]; i < runs_->point[r + 1]; ++i) {
        double& here = least_[i];
        here -= way;
        if (here <= reach) here = std::min(look(i), far_mm);
        least = std::min(least, here);
      }
      least_of_run_[r] = least;
      seen(r);
    }
  }

 private:
  /// Points that stand together in the list, and the nodes that carry them.
  struct Runs {
    std::vector<int> point, first_node, node;
    explicit Runs(const std::vector<NetPoint>& points);
  };
  static constexpr double far_mm = 1e6;
  double way_of_run(std::size_t run) const;
  void seen(std::size_t run);

  std::shared_ptr<const Runs> runs_;
  Nodes last_;
  std::vector<double> way_;       // of each node so far, mm
  std::vector<double> way_then_;  // of each run's nodes, when its points were looked at
  std::vector<double> least_;     // of each point: no nearer then
  std::vector<double> least_of_run_;
};

}  // namespace condyle
