#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/minimize/objective.h"

namespace condyle {

/// A muscle's line through points: of the tissue, each interpolated between nodes, or fixed. Its
/// tension is the same along the whole line. It pulls, and never pushes: the tension rises linearly
/// from the shortest length on, up to a limit; or it is the limit times Hill's active force-length
/// curve.
struct MuscleLine {
  struct Point {
    std::vector<int> node = {};
    std::vector<double> weight = {};                  // one per node, positive
    Eigen::Vector3d fixed = Eigen::Vector3d::Zero();  // mm, added; the place if without nodes

    /// For a displacement d of the nodes, the point's.
    Eigen::Vector3d moved(const Points& d) const {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::size_t k = 0; k < node.size(); ++k) sum += weight[k] * d[node[k]];
      return sum;
    }
    Eigen::Vector3d at(const Points& x) const { return fixed + moved(x); }
  };
  std::vector<Point> points;  // two or more; a closed line repeats the first
  double shortest = 0;        // mm, above 0: without tension up to here
  double stiffness = 0;       // N/mm beyond
  double limit = 0;           // N
  double optimal = 0;         // mm; above 0: Hill's law, with the limit at this length

  /// Width of the force-length curve exp(-(length / optimal - 1)^2 / width); source: Thelen 2003.
  static constexpr double hill_width = 0.45;

  double length(const Points& x) const {
    double sum = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      sum += (points[i].at(x) - points[i - 1].at(x)).norm();
    return sum;
  }

  /// Energy (mJ) at a length, and its derivatives by it.
  struct Law {
    double energy, tension, rise;
  };
  Law law(double length) const {
    if (optimal > 0) return hill(length);
    const double over = length - shortest, full = stiffness > 0 ? limit / stiffness : 0;
    if (over <= 0 || full <= 0) return {0, 0, 0};
    if (over < full) return {0.5 * stiffness * over * over, stiffness * over, stiffness};
    return {limit * (over - 0.5 * full), limit, 0};
  }

  Law hill(double length) const {
    const double over = length / optimal - 1, root = std::sqrt(hill_width);
    const double tension = limit * std::exp(-over * over / hill_width);
    const double area = std::erf(over / root) + std::erf(1 / root);  // from length 0 on
    return {0.5 * std::sqrt(std::numbers::pi) * root * limit * optimal * area, tension,
            -2 * over / (hill_width * optimal) * tension};
  }

  double energy(const Points& x) const { return law(length(x)).energy; }

  /// The same, and calls push(node, gradient).
  template <class Push>
  double energy_and_gradient(const Points& x, const Push& push) const {
    const Law now = law(length(x));
    if (now.tension <= 0) return now.energy;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Eigen::Vector3d pull = now.tension * direction(i, x).unit;
      for (const auto& [point, sign] : {std::pair(i, 1.0), std::pair(i - 1, -1.0)})
        for (std::size_t k = 0; k < points[point].node.size(); ++k)
          push(points[point].node[k], sign * points[point].weight[k] * pull);
    }
    return now.energy;
  }

  /// Second derivative of the energy along d; negative only where Hill's law falls with the length.
  double curvature(const Points& x, const Points& d) const {
    const Law now = law(length(x));
    if (now.tension <= 0) return 0;
    double stretch = 0, turn = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Direction along = direction(i, x);
      if (along.length <= 0) continue;
      const Eigen::Vector3d change = points[i].moved(d) - points[i - 1].moved(d);
      const double longer = change.dot(along.unit);
      stretch += longer;
      turn += (change.squaredNorm() - longer * longer) / along.length;
    }
    return now.rise * stretch * stretch + now.tension * turn;
  }

  /// From point i - 1 to point i; zero if they coincide.
  struct Direction {
    Eigen::Vector3d unit;
    double length;
  };
  Direction direction(std::size_t i, const Points& x) const {
    const Eigen::Vector3d span = points[i].at(x) - points[i - 1].at(x);
    const double length = span.norm();
    if (length <= 0) return {Eigen::Vector3d::Zero(), 0};
    return {span / length, length};
  }
};

}  // namespace condyle
