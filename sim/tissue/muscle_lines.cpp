#include "sim/tissue/muscle_lines.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/smooth_step.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/case/face_muscle_table.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The tension is full where a line is longer than its shortest by this fraction of its rest.
constexpr double full_over = 0.1;
/// Loose anchors yield to this fraction of their stiffness near a muscle with this excitation.
constexpr double least_scale = 0.006;
constexpr double loose_from = 0.3;
/// mm from a muscle: fully yielding to here, and not at all so much farther.
constexpr double yields_mm = 15, yields_over_mm = 20;

double of_muscle(std::span<const double> excitation, int muscle) {
  const auto m = static_cast<std::size_t>(muscle);
  return m < excitation.size() ? excitation[m] : 0;
}

/// Coordinates in a column prism: weights of the corners, and the depth in it.
struct InPrism {
  double u = 0, v = 0, t = 0, distance = std::numeric_limits<double>::infinity();
};

InPrism locate(const Nodes& x, const std::array<int, 6>& p, const Vector3d& at, double least_t,
               double most_t) {
  InPrism c{.u = 1.0 / 3, .v = 1.0 / 3, .t = 0.5};
  const auto point = [&](double u, double v, double t) -> Vector3d {
    const Vector3d top = (1 - u - v) * x[p[0]] + u * x[p[1]] + v * x[p[2]];
    const Vector3d low = (1 - u - v) * x[p[3]] + u * x[p[4]] + v * x[p[5]];
    return (1 - t) * top + t * low;
  };
  for (int round = 0; round < 12; ++round) {
    const Vector3d r = at - point(c.u, c.v, c.t);
    Eigen::Matrix3d J;
    J.col(0) = (1 - c.t) * (x[p[1]] - x[p[0]]) + c.t * (x[p[4]] - x[p[3]]);
    J.col(1) = (1 - c.t) * (x[p[2]] - x[p[0]]) + c.t * (x[p[5]] - x[p[3]]);
    J.col(2) = (1 - c.u - c.v) * (x[p[3]] - x[p[0]]) + c.u * (x[p[4]] - x[p[1]]) +
               c.v * (x[p[5]] - x[p[2]]);
    const Vector3d step = J.partialPivLu().solve(r);
    c.u = std::clamp(c.u + step.x(), -0.2, 1.2);
    c.v = std::clamp(c.v + step.y(), -0.2, 1.2);
    c.t = std::clamp(c.t + step.z(), -3.0, 4.0);
  }
  c.u = std::max(0.0, c.u);
  c.v = std::max(0.0, c.v);
  if (const double sum = c.u + c.v; sum > 1) c.u /= sum, c.v /= sum;
  c.t = std::clamp(c.t, least_t, most_t);
  c.distance = (at - point(c.u, c.v, c.t)).norm();
  return c;
}

/// The column at a point, by the whole depth of the tissue.
struct AtColumn {
  Eigen::Vector3i column = Eigen::Vector3i::Zero();
  std::array<double, 3> weight{};
  double depth = 0;  // of the point, 0 to 1
};

AtColumn column_at(const TissueMesh& mesh, const Vector3d& at) {
  constexpr double reach_mm = 15;  // beyond the nearest
  const int sheets = mesh.sheets;
  const auto distance = [&](const Eigen::Vector3i& t) {
    Vector3d centre = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      for (const int sheet : {0, sheets - 1}) centre += mesh.rest[node_of(t[k], sheet, sheets)] / 6;
    return (centre - at).norm();
  };
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3i& t : mesh.triangles) nearest = std::min(nearest, distance(t));
  InPrism best;
  AtColumn found;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto node = [&](int k, int sheet) { return node_of(t[k], sheet, sheets); };
    if (distance(t) > nearest + reach_mm) continue;
    const InPrism in = locate(mesh.rest,
                              {node(0, 0), node(1, 0), node(2, 0), node(0, sheets - 1),
                               node(1, sheets - 1), node(2, sheets - 1)},
                              at, 0, 1);
    if (in.distance < best.distance) best = in, found.column = t;
  }
  found.depth = best.t;
  found.weight = {1 - best.u - best.v, best.u, best.v};
  return found;
}

/// Weights of a column's nodes at a depth.
void add_column(const TissueMesh& mesh, int column, double depth, double weight,
                MuscleLine::Point& to) {
  const double among = depth * (mesh.sheets - 1);
  const int sheet = std::clamp(static_cast<int>(among), 0, mesh.sheets - 2);
  for (const int below : {0, 1}) {
    const double part = weight * (below ? among - sheet : 1 - (among - sheet));
    if (part <= 0) continue;
    to.node.push_back(node_of(column, sheet + below, mesh.sheets));
    to.weight.push_back(part);
  }
}

TissueMuscles::Point in_tissue(const TissueMesh& mesh, const FaceMusclePoint& p) {
  TissueMuscles::Point point;
  const AtColumn at = column_at(mesh, p.at);
  const double depth = p.depth.value_or(at.depth);
  if (p.spread_mm <= 0) {
    for (std::size_t k = 0; k < 3; ++k)
      add_column(mesh, at.column[static_cast<int>(k)], depth, at.weight[k], point.carried);
  } else {
    Vector3d skin = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      skin +=
          at.weight[static_cast<std::size_t>(k)] * mesh.rest[node_of(at.column[k], 0, mesh.sheets)];
    double sum = 0;
    std::vector<std::pair<int, double>> columns;
    for (int c = 0; c < mesh.columns; ++c) {
      const double far = (mesh.rest[node_of(c, 0, mesh.sheets)] - skin).norm() / p.spread_mm;
      if (far > 2) continue;
      columns.emplace_back(c, std::exp(-0.5 * far * far));
      sum += columns.back().second;
    }
    if (columns.size() < 3) return in_tissue(mesh, {.at = p.at, .depth = depth});
    for (const auto& [c, weight] : columns) add_column(mesh, c, depth, weight / sum, point.carried);
  }
  point.rest = point.carried.at(mesh.rest);
  return point;
}

MuscleLine line_at(const TissueMuscles::Line& of, std::span<const Pose> X_CB) {
  MuscleLine line;
  for (const TissueMuscles::Point& point : of.points) {
    line.points.push_back(point.carried);
    if (point.bone) line.points.back().fixed = pose_in(X_CB, *point.bone) * point.rest;
  }
  return line;
}

void find_yielding(const TissueMesh& mesh, const TissueSupport& support, TissueMuscles& made) {
  for (std::size_t i = 0; i < support.kind.size(); ++i) {
    if (support.kind[i] != AnchorKind::other) continue;
    const Vector3d& at = mesh.rest[mesh.elements.anchor_node[i]];
    std::vector<double> distance(made.muscles.size(), std::numeric_limits<double>::infinity());
    for (const TissueMuscles::Line& line : made.lines)
      for (const TissueMuscles::Point& point : line.points)
        if (!point.bone) {
          double& least = distance[static_cast<std::size_t>(line.muscle)];
          least = std::min(least, (point.rest - at).norm());
        }
    for (std::size_t m = 0; m < distance.size(); ++m) {
      const double closeness = 1 - smooth_step((distance[m] - yields_mm) / yields_over_mm);
      if (closeness > 0)
        made.yielding.push_back({static_cast<int>(m), static_cast<int>(i), closeness});
    }
  }
}

}  // namespace

std::vector<double> anchor_scales(const TissueMuscles& muscles, std::span<const double> excitation,
                                  std::size_t anchors) {
  std::vector<double> scale;
  for (const auto& [muscle, anchor, closeness] : muscles.yielding) {
    const double a = of_muscle(excitation, muscle);
    if (a <= 0) continue;
    if (scale.empty()) scale.assign(anchors, 1);
    const double loosened = smooth_step(std::min(1.0, a / loose_from)) * closeness;
    double& of_anchor = scale[static_cast<std::size_t>(anchor)];
    of_anchor = std::min(of_anchor, std::pow(least_scale, loosened));
  }
  return scale;
}

TissueMuscles muscles_in_mesh(const TissueMesh& mesh, const TissueSupport& support,
                              std::vector<FaceMuscle> muscles, bool upper_face) {
  TissueMuscles made;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const FaceMuscle& muscle = muscles[m];
    if (!upper_face && pulls_upper_face(muscle.kind)) continue;
    for (const auto& points : muscle.lines) {
      TissueMuscles::Line line{
          .muscle = static_cast<int>(m),
          .points = {},
          .rest_mm = 0,
          .limit_N = muscle.limit_N / static_cast<double>(muscle.lines.size())};
      for (const FaceMusclePoint& p : points)
        line.points.push_back(
            p.bone ? TissueMuscles::Point{.carried = {}, .bone = p.bone, .rest = p.at}
                   : in_tissue(mesh, p));
      line.rest_mm = line_at(line, {}).length(mesh.rest);
      made.lines.push_back(std::move(line));
    }
  }
  made.muscles = std::move(muscles);
  find_yielding(mesh, support, made);
  return made;
}

std::vector<MuscleLine> muscle_pull(const TissueMuscles& muscles,
                                    std::span<const double> excitation,
                                    std::span<const Pose> X_CB) {
  std::vector<MuscleLine> pull;
  for (const TissueMuscles::Line& of : muscles.lines) {
    const double a = of_muscle(excitation, of.muscle);
    if (a <= 0) continue;
    const FaceMuscle& muscle = muscles.muscles[static_cast<std::size_t>(of.muscle)];
    MuscleLine line = line_at(of, X_CB);
    line.limit = a * of.limit_N;
    if (muscle.law == FaceMuscleLaw::hill) {
      line.optimal = of.rest_mm;
    } else {
      line.shortest = (1 - a * muscle.shortening) * of.rest_mm;
      line.stiffness = of.limit_N / (full_over * of.rest_mm);
    }
    pull.push_back(std::move(line));
  }
  return pull;
}

TissueMuscles at_new_rest(TissueMuscles muscles, const Nodes& nodes, std::span<const Pose> X_CB) {
  for (TissueMuscles::Line& line : muscles.lines) line.rest_mm = line_at(line, X_CB).length(nodes);
  return muscles;
}

std::vector<double> muscle_lengths(const TissueMuscles& muscles, const Nodes& nodes,
                                   std::span<const Pose> X_CB) {
  std::vector<double> length(muscles.muscles.size(), 0);
  for (const TissueMuscles::Line& line : muscles.lines) {
    const auto m = static_cast<std::size_t>(line.muscle);
    length[m] +=
        line_at(line, X_CB).length(nodes) / static_cast<double>(muscles.muscles[m].lines.size());
  }
  return length;
}

}  // namespace condyle
