#pragma once

#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/body_tree.h"
#include "sim/frame/part.h"

namespace condyle {

/// Pose of every rigid body: X_CB[b] maps body b from rest to now, in the cranium's frame.
struct BodyPoses {
  std::vector<Pose> X_CB;  // by body number; bodies beyond the end are at rest

  BodyPoses() = default;
  explicit BodyPoses(std::vector<Pose> poses) : X_CB(std::move(poses)) {}
  /// A native mandible at a pose (see completed()). Where the body tree is known, use
  /// with_jaw_at().
  BodyPoses(const Pose& X_CM) : X_CB{Pose{}, X_CM} {}  // NOLINT: a pose of the jaw alone is one

  const Pose& operator[](BodyId body) const;
  Pose& operator[](BodyId body);  // extends the list to include the body
};

/// Pose of a body, rest to now, in the frame of reference of another body.
Pose pose_in(BodyId reference, BodyId body, const BodyPoses& at);

/// Pose of a rigid part, rest to now, in the cranium's frame.
inline const Pose& pose_of(const Part& part, const BodyPoses& at) { return at[part.body]; }

/// The body of the lower teeth, else of the mandible, else the native one: for drawing, where only
/// the parts are known.
BodyId lower_jaw_of(std::span<const Part> parts);

/// Poses of all bodies of a tree: those beyond the end of `at` move with their parents.
BodyPoses completed(const BodyTree& tree, BodyPoses at);

/// Poses of all bodies from those in their parents' frames; missing ones are at rest.
BodyPoses placed(const BodyTree& tree, std::span<const Pose> X_PB);

/// Pose of each body in its parent's frame. `at` has all bodies.
std::vector<Pose> in_parents(const BodyTree& tree, const BodyPoses& at);

/// Target poses in the parents' frames for a motion of the jaw: X_CM for the bodies that it drives,
/// others as in `others` (missing ones at rest).
std::vector<Pose> motion_target_poses(const BodyTree& tree, const Pose& X_CM,
                                      std::span<const Pose> others = {});

/// `at` with the bodies that a motion drives at X_CM, and all their descendants carried along.
BodyPoses with_jaw_at(const BodyTree& tree, const BodyPoses& at, const Pose& X_CM);
/// The same with all other bodies at rest.
BodyPoses with_jaw_at(const BodyTree& tree, const Pose& X_CM);

/// X_CP * X_PB, exact where one of them is at rest.
Pose composed(const Pose& X_CP, const Pose& X_PB);

bool bit_identical(const Pose& a, const Pose& b);

}  // namespace condyle
