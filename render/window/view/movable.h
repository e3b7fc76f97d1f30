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

/// A body that a hand can move, with all that hang on it: the mandible, the cranium (with the skull
/// in the room, where the jaw stays meanwhile), a segment or a transplant.
struct MovableBody {
  std::size_t part = 0;  // that names it
  BodyId body = mandible_body;
  BodyId parent = cranium_body;  // in whose frame it is moved; of the cranium: none
  bool follows_motion = true;    // where no hand has it
  Eigen::Vector3d center =
      Eigen::Vector3d::Zero();  // of its box at rest; it turns about this point

  bool is_skull() const { return body == cranium_body; }
  bool roams() const { return !is_skull() && !follows_motion; }
};

/// What a motion moves first, then the skull, then other bodies in their order.
std::vector<MovableBody> movable_bodies(std::span<const Part> parts, const BodyTree& bodies);

/// Number of the movable body that the part belongs to; none when it cannot be moved.
std::optional<std::size_t> movable_body_of(std::span<const MovableBody> bodies,
                                           std::span<const Part> parts, std::size_t part);

/// Target poses of bodies moved by hand, rest to now. Coordinate frames: the world R, in which the
/// window's camera is placed; the cranium C, in which all else is expressed; the mandible M.
struct Hands {
  // Of each body in its parent's frame (the cranium's is the room: X_RC); none, or beyond the end:
  // no hand has it, so that it follows the motion or is as at rest.
  std::vector<std::optional<Pose>> X_PB;
  std::optional<Pose> X_RM;    // set: the jaw stays there, against the skull that moves
  BodyId jaw = mandible_body;  // of the lower arch

  std::optional<Pose> at(BodyId body) const;
  void set(BodyId body, const std::optional<Pose>& target);

  /// Of a jaw that is held by hand.
  std::optional<Pose> X_CM_target() const;
  /// Of the skull with the jaw where it is: what contact keeps from the jaw is the skull if it was
  /// moved last.
  Pose X_RC(const Pose& X_CM) const;

  /// The target of a body as its numbers show it; none: it is not held by hand.
  std::optional<Pose> of(const MovableBody& body) const;
  /// An edit; the jaw is at X_CM.
  void move(const MovableBody& body, const Pose& target, const Pose& X_CM);
  void put_back(const MovableBody& body, const Pose& X_CM);
  /// Sets the jaw's target to X_CM and discards the skull's.
  void hold_jaw(const Pose& X_CM);
  /// Of the hand that has it; the skull stays where it has come to.
  void release_jaw(const Pose& X_CM);
  /// Whether both have the same targets for both jaws.
  bool same_jaws(const Hands& other) const;
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

/// Whether both are the same to the bit, or none.
bool same(const std::optional<Pose>& a, const std::optional<Pose>& b);

}  // namespace condyle
