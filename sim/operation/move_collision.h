#pragma once

#include <optional>
#include <string>

#include "sim/operation/segment_overlaps.h"

namespace condyle {

/// A move in words that makes bones of different origin collide.
struct MoveCollision {
  double free_fraction = 0;  // of the move, up to which nothing collides
  ClinicalMove free;         // that part of it
  std::string words;         // the deepest collision and the free part, for people
};

/// The collision of a step's move; absent where none is. `operated`: the plan with the step.
std::optional<MoveCollision> move_collision(const Operated& operated, const Plan& plan,
                                            const MoveStep& step);

}  // namespace condyle
