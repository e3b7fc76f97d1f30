#pragma once

#include <string>
#include <vector>

namespace condyle {

/// One scene of rigid bodies, by the engine's own constraint rows or by plain Bullet: its
/// unmodified joints, contacts and sequential impulses in double precision, at the same step of 1
/// ms.
struct RigidRun {
  std::vector<double> step_ms;  // processor time of each step
  double joint_error_mm = 0;    // largest distance of two hooks that belong together
  double energy_gain = 0;       // largest, relative to the potential energy of the fall
  double energy_loss = 0;       // at the end
  double depth_mm = 0;          // of the deepest corner below the plane, after settling
  double drift_mm = 0;          // displacement of a block that friction should hold
  double slide_error = 0;       // of the displacement of a block that should slide, relative
};

enum class RigidMethod { condyle, bullet };

/// Four planks of bone hang from each other on ball joints and swing for two seconds.
RigidRun swing_chain(RigidMethod method);

/// A block of bone rests on a plane of 20 degrees for two seconds (friction 0.5 holds it), then an
/// equal one slides for a tenth of a second on a plane of 35 degrees.
RigidRun slide_block(RigidMethod method);

}  // namespace condyle
