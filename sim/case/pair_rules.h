#pragma once

#include <span>
#include <string>

#include "sim/case/case.h"

namespace condyle {

/// The rule for two parts: the default, or the last of the case's and then of `more` that names
/// both ("*" matches any).
PairRule rule_for(const Case& patient, std::span<const PairRule> more, const Part& a,
                  const Part& b);

/// throws: InputError for an unknown part name (listing the valid ones), and for a margin or gap
/// that is not a number of at least 0. `where`: source of the rules, for the message.
void check_rules(const Case& patient, std::span<const PairRule> rules, const std::string& where);

/// Names of the parts that a rule can refer to, for messages: "skull, mandible, ...".
std::string rule_part_names(const Case& patient);
bool is_rule_part(const Case& patient, const std::string& name);

std::string known_policies();  // "forbidden, allowed, guided, cut-face"

}  // namespace condyle
