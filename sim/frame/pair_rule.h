#pragma once

#include <optional>
#include <string>

#include "sim/frame/part.h"

namespace condyle {

/// What two surfaces may do to each other.
enum class PairPolicy {
  forbidden,  // may not touch, and keep the margin
  allowed,    // may touch, not overlap: teeth
  guided,     // glide on each other at a gap which they keep: condyle and fossa with their disc
  cut_face    // were one before the cut: faces lie on each other and may be within a saw's width
};

/// The rule of one pair of parts. `a` and `b` in either order; "*" is any part.
struct PairRule {
  std::string a, b;
  PairPolicy policy = PairPolicy::forbidden;
  std::optional<double> margin_mm;  // clearance to keep, at least 0; else what the check asks for
  double gap_mm = 0;                // of a guided pair, at least 0
};

/// Teeth may touch teeth, a free part the one that carries it; all else is forbidden.
PairRule usual_rule(const Part& a, const Part& b);

/// "forbidden", "allowed", "guided", "cut-face".
std::string policy_name(PairPolicy policy);
std::optional<PairPolicy> policy_named(const std::string& name);

}  // namespace condyle
