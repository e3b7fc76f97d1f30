#pragma once

#include <string>
#include <vector>

#include "sim/operation/operation.h"

namespace condyle {

/// Replays the trims of a plan at the planned positions. Each segment is cut by the cut faces of
/// the others, moved with them, and what lies beyond is removed; where two segments do not overlap,
/// nothing is. Extends `operated.trims` and its `problems`: no saw cut between two segments, a
/// tooth beyond the cut, a segment without bone, nothing left.
void trim_segments(Operated& operated, const Plan& plan);

/// The bodies whose bone overlaps that of a segment and could keep it, deepest overlap first.
std::vector<std::string> trimming_segments(const Operated& operated, const std::string& segment);

/// "812 mm³ of distal removed beyond the cut faces of proximal_left; 44.2 cm³ left".
std::vector<std::string> trim_sentences(const TrimReport& report);

}  // namespace condyle
