#pragma once

#include <algorithm>

#include "sim/motion/motion.h"

namespace condyle::test {

/// Up by a height in half a second.
inline Motion lift(double height_mm) {
  return {"lift",
          0.5,
          true,
          [height_mm](double t) {
            Pose pose;
            pose.t = {0, 0, height_mm * std::clamp(t, 0.0, 0.5) / 0.5};
            return pose;
          },
          {}};
}

}  // namespace condyle::test
