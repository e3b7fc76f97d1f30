#pragma once

#include <optional>
#include <string>

#include "sim/frame/part.h"

namespace condyle {

/// Contact rule of two surfaces.
enum class PairPolicy {
  forbidden,  // may not touch, and keep a margin
  allowed,    // may touch, not overlap: teeth
  guided,     // glide on each other at a constant gap: condyle and fossa with their disc
  cut_face    // were one before the cut: the faces may touch and overlap by the width of a saw
};

/// The rule of one pair of parts. `a` and `b` in either order; "*" is any part.
struct PairRule {
  std::string a, b;
  PairPolicy policy = PairPolicy::forbidden;
  // clearance to keep, at least 0; default: the margin of the check
  std::optional<double> margin_mm;
  double gap_mm = 0;  // of a guided pair, at least 0
};

/// Teeth may touch teeth, and a body the one that it was cut from (BodyLink::cut); all other pairs
/// are forbidden.
PairRule default_rule(const BodyTree& bodies, const Part& a, const Part& b);

/// "forbidden", "allowed", "guided", "cut-face".
std::string policy_name(PairPolicy policy);
std::optional<PairPolicy> policy_named(const std::string& name);

}  // namespace condyle
