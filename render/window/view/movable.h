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

/// A body that a hand can move with its descendants: the mandible, the cranium (in the room, where
/// the jaw stays meanwhile), a segment or a transplant.
struct MovableBody {
  std::size_t part = 0;  // that names it
  BodyId body = mandible_body;
  BodyId parent = cranium_body;  // in whose frame it is moved; of the cranium: none
  bool follows_motion = true;    // unless held by hand
  // It turns about this point at rest: the middle of its box, or a named one.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  std::string point = {};  // its name, for people; empty: the middle
  // Directions of its moves, as columns: left, back, up.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();

  bool is_skull() const { return body == cranium_body; }
  bool roams() const { return !is_skull() && !follows_motion; }
};

/// Whether a saw cut can be drawn on it. Transplants are shaped by their own steps.
bool can_be_cut(const Part& part);

/// The bodies that a motion drives first, then the skull, then the others in their order.
std::vector<MovableBody> movable_bodies(std::span<const Part> parts, const BodyTree& bodies);

/// Number of the movable body that the part belongs to; none when it cannot be moved.
std::optional<std::size_t> movable_body_of(std::span<const MovableBody> bodies,
                                           std::span<const Part> parts, std::size_t part);

/// Target poses of bodies moved by hand, rest to now. Coordinate frames: the world R, in which the
/// window's camera is placed; the cranium C, in which all else is expressed; the mandible M.
struct Hands {
  // Target of each body in its parent's frame (the cranium's is the room: X_RC); none, or beyond
  // the end: not held by hand, so that it follows the motion or is at rest.
  std::vector<std::optional<Pose>> X_PB;
  std::optional<Pose> X_RM;    // set: the jaw stays there while the skull moves
  BodyId jaw = mandible_body;  // of the lower arch

  std::optional<Pose> at(BodyId body) const;
  void set(BodyId body, const std::optional<Pose>& target);

  /// Target of a jaw that is held by hand.
  std::optional<Pose> X_CM_target() const;
  /// Pose of the skull for the present jaw: contact stops the skull instead of the jaw if the skull
  /// was moved last.
  Pose X_RC(const Pose& X_CM) const;

  /// The target of a body as its numbers show it; none: it is not held by hand.
  std::optional<Pose> of(const MovableBody& body) const;
  /// Applies an edit; the jaw is at X_CM.
  void move(const MovableBody& body, const Pose& target, const Pose& X_CM);
  void put_back(const MovableBody& body, const Pose& X_CM);
  /// Sets the jaw's target to X_CM and discards the skull's.
  void hold_jaw(const Pose& X_CM);
  /// Releases the jaw from the hand; the skull stays at its present pose.
  void release_jaw(const Pose& X_CM);
  /// Whether both have the same targets for both jaws.
  bool same_jaws(const Hands& other) const;
  bool operator==(const Hands& other) const;
};

/// A pose as readable numbers: displacement of the body's centre along its axes, to the left, back
/// and up, mm, and rotations about these axes through it, deg: first about left, then back, then
/// up.
struct Placement {
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_deg = Eigen::Vector3d::Zero();
};
Placement placement_of(const Pose& pose, const Eigen::Vector3d& center,
                       const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());
Pose pose_at(const Placement& placement, const Eigen::Vector3d& center,
             const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());
/// The pose with its numbers rounded to half a millimetre and a whole degree.
Pose snapped(const Pose& pose, const MovableBody& body);

/// Whether both are bit-identical, or none.
bool same(const std::optional<Pose>& a, const std::optional<Pose>& b);

}  // namespace condyle
