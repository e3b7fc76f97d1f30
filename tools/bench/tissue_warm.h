#pragma once

#include <nlohmann/json.hpp>

#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {

/// Times of the frames of a steady opening, half a degree each, at the pace of the frame loop while
/// they keep to it. A frame starts from the last one, taken on by the bones' motion and what the
/// tissue's own motion foretells, with a factor made beside the loop some frames before, or with
/// one thread in the time between frames, which is reported. A frame's time has in it what it
/// waited for a factor. A frame that has spent its budget is left as it is. Errors are measured
/// against solves that go on from there; above 0.1 mm the row has no time. `name`: of the row.
nlohmann::ordered_json warm_frames(const SyntheticSet& set, int threads, const char* name);

}  // namespace condyle
