#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/part.h"

namespace condyle {

/// Where every body is, in the cranium's frame: each pose maps the body from rest to now.
struct BodyPoses {
  Pose X_CM;
  std::vector<Pose> X_CF;  // of each free part, in the case's order; missing ones stay with their
                           // carrier as at rest

  BodyPoses() = default;
  BodyPoses(const Pose& mandible, std::vector<Pose> free = {})  // NOLINT: a mandible alone is one
      : X_CM(mandible), X_CF(std::move(free)) {}
};

/// Indices of the free parts, in order.
std::vector<std::size_t> free_parts(std::span<const Part> parts);

/// Pose of a rigid part, rest to now.
Pose pose_of(std::span<const Part> parts, std::size_t part, const BodyPoses& at);

}  // namespace condyle
