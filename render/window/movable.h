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

/// A body that a hand can move: the mandible or the skull with all they carry, a segment or a
/// transplant.
struct MovableBody {
  std::size_t part = 0;             // that names it
  std::optional<std::size_t> free;  // its number among the free parts; none: a jaw
  bool skull = false;               // it is moved in the room, where the jaw stays meanwhile
  Body carrier = Body::cranium;     // in whose frame another body is moved
  Eigen::Vector3d center =
      Eigen::Vector3d::Zero();  // of its box at rest; it turns about this point
};

/// The mandible first, then the skull, then free parts in their order.
std::vector<MovableBody> movable_bodies(std::span<const Part> parts);

/// Number of the body that the part belongs to; none when it cannot be moved.
std::optional<std::size_t> movable_body_of(std::span<const MovableBody> bodies,
                                           std::span<const Part> parts, std::size_t part);

/// Where the hand wants bodies, rest to now. Coordinate frames: the room R, in which the window's
/// camera stands; the cranium C, in which all else is told; the mandible M.
struct Hands {
  std::optional<Pose> mandible;           // X_CM; none: it follows the motion
  std::optional<Pose> skull;              // X_RC; none: the room is the cranium's frame
  std::optional<Pose> X_RM;               // set: the jaw stays there, against the skull that moves
  std::vector<std::optional<Pose>> free;  // in their carriers' frames; none: as at rest

  /// Of a jaw that a hand has.
  std::optional<Pose> X_CM_wanted() const;
  /// Of the skull with the jaw where it is: what contact keeps from the jaw is the skull if it was
  /// moved last.
  Pose X_RC(const Pose& X_CM) const;

  /// What is wanted of a body as its numbers tell it; none: no hand has it.
  std::optional<Pose> of(const MovableBody& body) const;
  /// An edit; the jaw is at X_CM.
  void move(const MovableBody& body, const Pose& wanted, const Pose& X_CM);
  void put_back(const MovableBody& body, const Pose& X_CM);
  /// The jaw is wanted at X_CM, whatever was wanted of the skull.
  void hold_jaw(const Pose& X_CM);
  /// Of the hand that has it; the skull stays where it has come to.
  void release_jaw(const Pose& X_CM);
  /// Both jaws are wanted where the others want them.
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

/// Where the carrier of a body other than the skull is: its pose in the cranium's frame is carrier
/// * pose.
Pose carrier_pose(const MovableBody& body, const Pose& X_CM);

}  // namespace condyle
