#include <algorithm>
#include <array>
#include <cmath>

#include "engine/collide/overlap_measure.h"

namespace condyle {
namespace {

/// Columns along axis `w` over a rectangle of the plane of `u` and `v`.
struct Columns {
  int u, v, w;
  Eigen::Vector2d low, step = Eigen::Vector2d::Zero();
  int count_u = 0, count_v = 0;

  Eigen::Vector2d middle(int i, int j) const {
    return low + step.cwiseProduct(Eigen::Vector2d(i + 0.5, j + 0.5));
  }
};

/// An intersection of a surface with a column.
struct Crossing {
  int column = 0;
  double height = 0;
  int body = 0;   // 0 A, 1 B
  int turns = 0;  // +1 going in, -1 coming out

  bool operator<(const Crossing& other) const {
    if (column != other.column) return column < other.column;
    if (height != other.height) return height < other.height;
    if (body != other.body) return body < other.body;
    return turns < other.turns;
  }
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Whether x lies to the left of the line from p to q. Both triangles at an edge use the same
/// arithmetic, so no column is missed or counted twice.
bool left_of(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& x) {
  const bool forward = p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
  const Eigen::Vector2d &from = forward ? p : q, &to = forward ? q : p;
  return (cross(to - from, x - from) >= 0) == forward;
}

void cross_columns(const TriMesh& mesh, const Pose& X, const Columns& columns, int body,
                   std::vector<Crossing>& crossings) {
  std::vector<Eigen::Vector3d> moved;
  moved.reserve(mesh.vertices.size());
  for (const auto& p : mesh.vertices) {
    const Eigen::Vector3d q = X * p;
    moved.emplace_back(q[columns.u], q[columns.v], q[columns.w]);
  }
  const auto clamped = [&](double value, int count) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(count)));
  };
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d* t[3] = {&moved[triangle[0]], &moved[triangle[1]], &moved[triangle[2]]};
    const Eigen::Vector3d low = t[0]->cwiseMin(*t[1]).cwiseMin(*t[2]);
    const Eigen::Vector3d high = t[0]->cwiseMax(*t[1]).cwiseMax(*t[2]);
    const Eigen::Vector2d first = (low.head<2>() - columns.low).cwiseQuotient(columns.step);
    const Eigen::Vector2d last = (high.head<2>() - columns.low).cwiseQuotient(columns.step);
    const Eigen::Vector2d p[3] = {t[0]->head<2>(), t[1]->head<2>(), t[2]->head<2>()};
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    if (area == 0) continue;
    for (int j = clamped(first.y() - 1, columns.count_v);
         j < clamped(last.y() + 1, columns.count_v); ++j)
      for (int i = clamped(first.x() - 1, columns.count_u);
           i < clamped(last.x() + 1, columns.count_u); ++i) {
        const Eigen::Vector2d x = columns.middle(i, j);
        const bool side = left_of(p[0], p[1], x);
        if (left_of(p[1], p[2], x) != side || left_of(p[2], p[0], x) != side) continue;
        const double b1 = cross(x - p[0], p[2] - p[0]) / area,
                     b2 = cross(p[1] - p[0], x - p[0]) / area;
        const double height =
            t[0]->z() + b1 * (t[1]->z() - t[0]->z()) + b2 * (t[2]->z() - t[0]->z());
        // Seen along the column, a clockwise face points down: the column enters there.
        crossings.push_back(
            {j * columns.count_u + i, std::clamp(height, low.z(), high.z()), body, side ? -1 : 1});
      }
  }
}

struct Counted {
  double volume = 0;
  double quarter[4] = {};  // sums of every other column along both directions, by starting column
  Box used;                // of the columns with any overlap, in (u, v, 0)
};

Counted count(std::vector<Crossing>& crossings, const Columns& columns) {
  std::sort(crossings.begin(), crossings.end());
  Counted counted;
  const double cell = columns.step.prod();
  for (std::size_t i = 0; i < crossings.size();) {
    const int column = crossings[i].column;
    int inside[2] = {0, 0};
    double length = 0, before = 0;
    for (; i < crossings.size() && crossings[i].column == column; ++i) {
      const auto& crossing = crossings[i];
      if (inside[0] != 0 && inside[1] != 0) length += crossing.height - before;
      before = crossing.height;
      inside[crossing.body] += crossing.turns;
    }
    if (!(length > 0)) continue;
    const int u = column % columns.count_u, v = column / columns.count_u;
    counted.volume += cell * length;
    counted.quarter[u % 2 + 2 * (v % 2)] += 4 * cell * length;
    const Eigen::Vector2d middle = columns.middle(u, v);
    counted.used.add(Eigen::Vector3d(middle.x(), middle.y(), 0));
  }
  return counted;
}

}  // namespace

OverlapVolume overlap_volume(const TriMesh& a, const Pose& X_WA, const TriMesh& b, const Pose& X_WB,
                             int columns_along) {
  const Pose X_AB = X_WA.inverse() * X_WB;
  Box box_a, box_b;
  for (const auto& t : a.triangles)
    for (const int v : t) box_a.add(a.vertices[v]);
  for (const auto& t : b.triangles)
    for (const int v : t) box_b.add(X_AB * b.vertices[v]);
  Box box{box_a.low.cwiseMax(box_b.low), box_a.high.cwiseMin(box_b.high)};
  if (box_a.empty() || box_b.empty() || box.empty()) return {};

  Eigen::Index shortest = 0;
  box.size().minCoeff(&shortest);
  Columns columns;
  columns.w = static_cast<int>(shortest);
  columns.u = (columns.w + 1) % 3;
  columns.v = (columns.w + 2) % 3;
  Eigen::Vector2d low(box.low[columns.u], box.low[columns.v]);
  Eigen::Vector2d high(box.high[columns.u], box.high[columns.v]);
  OverlapVolume overlap;
  // Bones overlap in a small part of their common box: further passes resolve that part more
  // finely, long and narrow parts equally in both directions. Where a pass finds nothing, a finer
  // one may.
  constexpr int max_passes = 6, finest = 512;
  int along = std::max(8, columns_along);
  for (int pass = 0; pass < max_passes; ++pass) {
    const Eigen::Vector2d size = high - low;
    if (!(size.minCoeff() > 0)) break;
    columns.low = low;
    columns.count_u = columns.count_v = along;
    columns.step = size / along;
    std::vector<Crossing> crossings;
    cross_columns(a, Pose{}, columns, 0, crossings);
    cross_columns(b, X_AB, columns, 1, crossings);
    const Counted counted = count(crossings, columns);
    overlap = {counted.volume, 0};
    for (const double coarse : counted.quarter)
      overlap.error_mm3 = std::max(overlap.error_mm3, std::abs(coarse - counted.volume));
    if (counted.used.empty()) {
      if (along >= finest) break;
      along = std::min(4 * along, finest);
      continue;
    }
    // A column represents its cell, and a neighbouring column may have missed the overlap narrowly.
    const Eigen::Vector2d air = 1.5 * columns.step;
    const Eigen::Vector2d next_low = low.cwiseMax(counted.used.low.head<2>() - air);
    const Eigen::Vector2d next_high = high.cwiseMin(counted.used.high.head<2>() + air);
    const bool narrower = ((next_high - next_low).array() < 0.7 * size.array()).any();
    if (!narrower && along <= std::max(8, columns_along)) break;
    along = std::max(8, columns_along);
    low = next_low;
    high = next_high;
  }
  return overlap;
}

}  // namespace condyle
