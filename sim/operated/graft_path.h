#pragma once

#include <string>
#include <vector>

#include "sim/contact/insertion_path.h"
#include "sim/motion/motion.h"
#include "sim/operation/operation.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// The seats of a plan's grafts at the planned positions.
std::vector<Seat> graft_seats(const Operated& operated, const Plan& plan);

/// A graft that leaves its seat along its insertion path, and returns, with the jaw at rest. A
/// blocked path ends where it is blocked. `spec`: "path:GRAFT". throws: InputError for a scene
/// without a plan, and a graft that the plan lacks.
Motion insertion_path_motion(const std::string& spec, const Scene& scene, double duration_s,
                             int threads);

/// Whether a motion is the insertion path of a graft.
bool is_insertion_path(const std::string& spec);

}  // namespace condyle
