#include "sim/contact/graft_surroundings.h"

#include <algorithm>

#include "engine/collide/surface_samples.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double sample_mm = 0.8;

/// Samples deeper than this beside one that is nearer must not be missed.
float limit_beyond(const Clearance& least) {
  return static_cast<float>(std::max(least.mm, 2 * sample_mm));
}

QuickDistance::Start& start_of_none() {
  thread_local QuickDistance::Start start;
  start = {};
  return start;
}

Vector3d corner_of(const Box& box, int corner) {
  return {(corner & 1 ? box.low : box.high).x(), (corner & 2 ? box.low : box.high).y(),
          (corner & 4 ? box.low : box.high).z()};
}

Box moved_box(const Box& box, const Pose& X) {
  Box moved;
  for (int corner = 0; corner < 8; ++corner) moved.add(X * corner_of(box, corner));
  return moved;
}

}  // namespace

GraftSurroundings::GraftSurroundings(const Case& patient, const std::vector<BodyId>& graft,
                                     double reach_mm) {
  const auto moves = [&](const Part& part) {
    return std::find(graft.begin(), graft.end(), part.body) != graft.end();
  };
  for (const Part& part : patient.parts) {
    if (!collides(part.role) || part.mesh.empty()) continue;
    if (moves(part)) {
      const SurfaceSamples samples = sample_surface(
          part.mesh, {.spacing_mm = sample_mm, .edge_spacing_mm = sample_mm, .region = {}});
      points_.insert(points_.end(), samples.points.begin(), samples.points.end());
      box_.add(bounding_box(part.mesh));
      pieces_.emplace_back(part.mesh);
    } else {
      others_.push_back(
          {part.name, QuickDistance(part.mesh), bounding_box(part.mesh), part.mesh.vertices});
    }
  }
  for (Other& other : others_)  // what the graft cannot reach
    std::erase_if(other.corners,
                  [&](const Vector3d& p) { return !box_.contains(p, reach_mm + farthest_mm); });
}

double GraftSurroundings::displacement(const Pose& X) const {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d p = corner_of(box_, corner);
    most = std::max(most, (X * p - p).norm());
  }
  return most;
}

Clearance GraftSurroundings::at(const Pose& X) const {
  Clearance least{.mm = farthest_mm};
  const auto consider = [&](double mm, const Vector3d& p, const Other& other) {
    if (mm < least.mm) least = {mm, &other.name, p};
  };
  const Box box = moved_box(box_, X);
  const Pose back = X.inverse();
  const Eigen::Matrix3d R = X.R.toRotationMatrix(), R_back = back.R.toRotationMatrix();
  for (const Other& other : others_) {
    if ((box.low.array() > other.box.high.array() + farthest_mm).any() ||
        (other.box.low.array() > box.high.array() + farthest_mm).any())
      continue;
    QuickDistance::Start start;
    for (const Vector3d& p : points_)
      if (const Vector3d q = R * p + X.t; other.box.contains(q, limit_beyond(least)))
        consider(other.surface.signed_distance(q, limit_beyond(least), start), q, other);
    for (const Vector3d& p : other.corners)
      if (box.contains(p, limit_beyond(least)))
        for (const QuickDistance& piece : pieces_)
          consider(piece.signed_distance(R_back * p + back.t, limit_beyond(least), start_of_none()),
                   p, other);
  }
  return least;
}

}  // namespace condyle
