#pragma once

#include <array>

#include "engine/math/pose.h"

namespace condyle::test {

/// Poses of cranium and mandible, by the number of their bodies.
inline std::array<Pose, 2> jaw_at(const Pose& X_CM) { return {Pose{}, X_CM}; }

}  // namespace condyle::test
