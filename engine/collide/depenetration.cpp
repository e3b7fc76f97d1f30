#include "engine/collide/depenetration.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/core/infinity.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int max_steps = 200;  // per direction; grazing directions are abandoned

/// Evenly spread over the sphere.
std::vector<Vector3d> all_around(int count) {
  std::vector<Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count;
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return directions;
}

class SeparationSearch {
 public:
  SeparationSearch(const DepenetrationBody& a, const Pose& X_WA, const DepenetrationBody& b,
                   const Pose& X_WB, double precision_mm)
      : a_(a), b_(b), X_WA_(X_WA), X_WB_(X_WB), precision_mm_(precision_mm) {}

  bool overlap(const Vector3d& shift) const {
    const Pose X = moved(shift);
    return touching(a_.surface, X_WA_, b_.surface, X) ||
           one_encloses_other(a_.solid, X_WA_, b_.solid, X);
  }
  OverlapDepth depth(const Vector3d& shift) const {
    // An underestimated depth only shortens the step.
    return overlap_depth(a_.solid, X_WA_, b_.solid, moved(shift),
                         {.tolerance_mm = 5 * precision_mm_, .max_evaluations = 2000});
  }

  /// Length of the translation in this direction until the bodies are separated; infinite from
  /// `limit` on. A point inside cannot leave by a translation shorter than its depth.
  double length(const Vector3d& direction, double limit) const {
    double t = depth({0, 0, 0}).depth_mm;
    for (int step = 0; step < max_steps && t < limit; ++step) {
      const Vector3d shift = t * direction;
      if (!overlap(shift)) return t;
      t += std::max(depth(shift).depth_mm, 0.5 * precision_mm_);
    }
    return infinity;
  }

  /// Result of repeated translation along the normal at the deepest point; may fail.
  Vector3d follow_normals() const {
    Vector3d shift = Vector3d::Zero();
    for (int step = 0; step < 40 && overlap(shift); ++step) {
      const OverlapDepth found = depth(shift);
      shift += std::max(found.depth_mm, precision_mm_) * found.normal;
    }
    return shift;
  }

  /// After this length a plane separates them in any case.
  double length_to_plane(const Vector3d& direction) const {
    const Vector3d in_a = X_WA_.R.conjugate() * direction, in_b = X_WB_.R.conjugate() * direction;
    return std::max(0.0, a_.solid.extent(in_a) + direction.dot(X_WA_.t) + b_.solid.extent(-in_b) -
                             direction.dot(X_WB_.t));
  }

 private:
  Pose moved(const Vector3d& shift) const { return {X_WB_.R, X_WB_.t + shift}; }

  DepenetrationBody a_, b_;
  Pose X_WA_, X_WB_;
  double precision_mm_;
};

}  // namespace

Depenetration push_out(const DepenetrationBody& a, const Pose& X_WA, const DepenetrationBody& b,
                       const Pose& X_WB, const DepenetrationSettings& settings) {
  assert(settings.directions > 0 && settings.precision_mm > 0);
  Depenetration out;
  if (a.solid.open_shell_count() > 0 || b.solid.open_shell_count() > 0) return out;
  const SeparationSearch search(a, X_WA, b, X_WB, settings.precision_mm);
  if (!search.overlap(Vector3d::Zero())) {
    out.status = Depenetration::Status::apart;
    return out;
  }

  double best = infinity;
  const auto offer = [&](const Vector3d& direction) {
    const double length = search.length(direction, best);
    if (length < best) best = length, out.direction = direction;
  };
  // Promising directions first: the others are then abandoned early.
  if (const Vector3d hint = search.follow_normals(); hint.norm() > 0) offer(hint.normalized());
  offer(search.depth(Vector3d::Zero()).normal);
  std::vector<Vector3d> directions = all_around(settings.directions);
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)})
    for (const Pose& X : {X_WA, X_WB})
      for (const double sign : {1.0, -1.0}) directions.push_back(X.R * (sign * axis));
  Vector3d widest = directions.front();
  for (const auto& direction : directions)
    if (search.length_to_plane(direction) < search.length_to_plane(widest)) widest = direction;
  offer(widest);
  for (const auto& direction : directions) offer(direction);
  // In that direction a plane certainly separates them, even if all others were abandoned.
  if (best == infinity) {
    best = search.length_to_plane(widest) + settings.precision_mm;
    out.direction = widest;
  }

  for (double angle = 0.3; angle > 0.002; angle *= 0.6)
    for (bool better = true; better;) {
      better = false;
      const Vector3d from = out.direction, u = from.unitOrthogonal(), v = from.cross(u);
      for (int k = 0; k < 6 && !better; ++k) {
        const double turn = k * std::numbers::pi / 3;
        const double before = best;
        offer((from + std::tan(angle) * (std::cos(turn) * u + std::sin(turn) * v)).normalized());
        better = best < before - 0.1 * settings.precision_mm;
      }
    }
  out.length_mm = best;
  out.status = Depenetration::Status::found;
  return out;
}

}  // namespace condyle
