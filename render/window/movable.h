#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/part.h"

namespace condyle {

/// A body that a hand can move: the mandible with all it carries, a segment or a transplant.
struct MovableBody {
  std::size_t part = 0;             // that names it
  std::optional<std::size_t> free;  // its number among the free parts; none: the mandible
  Body carrier = Body::cranium;     // in whose frame it is moved
  Eigen::Vector3d center =
      Eigen::Vector3d::Zero();  // of its box at rest; it turns about this point
};

/// The mandible first, then free parts in their order.
std::vector<MovableBody> movable_bodies(std::span<const Part> parts);

/// Number of the body that the part belongs to; none when it cannot be moved.
std::optional<std::size_t> movable_body_of(std::span<const MovableBody> bodies,
                                           std::span<const Part> parts, std::size_t part);

/// Where the hand wants bodies, rest to now in their carriers' frames. None: the mandible follows
/// the motion, a free part stays as at rest.
struct Hands {
  std::optional<Pose> mandible;
  std::vector<std::optional<Pose>> free;

  std::optional<Pose>& of(const MovableBody& body);
  const std::optional<Pose>& of(const MovableBody& body) const;
  bool operator==(const Hands& other) const;
};

/// A pose as numbers that people read: how far the body's centre has gone to the left, back and up,
/// mm, and turns about these axes through it, deg: first about left, then back, then up.
struct Placement {
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_deg = Eigen::Vector3d::Zero();
};
Placement placement_of(const Pose& pose, const Eigen::Vector3d& center);
Pose pose_at(const Placement& placement, const Eigen::Vector3d& center);

/// Where the body's carrier is; a body's pose in the cranium's frame is carrier * pose.
Pose carrier_pose(const MovableBody& body, const Pose& X_CM);

}  // namespace condyle
