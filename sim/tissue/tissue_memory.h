#pragma once

#include <cstddef>

#include "sim/tissue/tissue.h"

namespace condyle {

/// Memory that a model holds, bytes.
struct TissueMemory {
  // the mesh with its springs, prisms and SIMD batches, what holds it, its contact points and
  // surfaces, and its states along the opening
  std::size_t tissue = 0;
  std::size_t displayed_face = 0;
  std::size_t bone_surfaces = 0;  // that the tissue touches, with their distance fields
  std::size_t factors = 0;        // preconditioners made so far
  int factors_made = 0;
  int factors_most = 0;               // along the whole opening
  std::size_t bytes_of_a_factor = 0;  // each beyond the first
  std::size_t most_factors() const {  // of the whole opening
    return factors + bytes_of_a_factor * static_cast<std::size_t>(factors_most - factors_made);
  }
};
TissueMemory memory_of(const TissueModel& model);

}  // namespace condyle
