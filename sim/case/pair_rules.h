#pragma once

#include <span>
#include <string>

#include "sim/case/case.h"

namespace condyle {

/// The rule for two parts: the usual one, or the last of the case's and then of `more` that names
/// both ("*" names any).
PairRule rule_for(const Case& patient, std::span<const PairRule> more, const Part& a,
                  const Part& b);

/// throws: InputError for a name that no part has (listing those there are), a margin or a gap that
/// is no number from 0 on. `where` tells where the rules were given.
void check_rules(const Case& patient, std::span<const PairRule> rules, const std::string& where);

/// Names of the parts that a rule can speak of, for messages: "skull, mandible, ...".
std::string rule_part_names(const Case& patient);
bool is_rule_part(const Case& patient, const std::string& name);

std::string known_policies();  // "forbidden, allowed, guided, cut-face"

}  // namespace condyle
