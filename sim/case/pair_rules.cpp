#include "sim/case/pair_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace condyle {
namespace {

bool names(const std::string& pattern, const Part& part) {
  return pattern == "*" || pattern == part.name;
}

bool fits(const PairRule& rule, const Part& a, const Part& b) {
  return (names(rule.a, a) && names(rule.b, b)) || (names(rule.a, b) && names(rule.b, a));
}

}  // namespace

PairRule rule_for(const Case& patient, std::span<const PairRule> more, const Part& a,
                  const Part& b) {
  PairRule rule = default_rule(patient.bodies, a, b);
  const auto take = [&](const PairRule& other) {
    if (!fits(other, a, b)) return;
    rule = other;
    rule.a = a.name;
    rule.b = b.name;
  };
  for (const auto& other : patient.pair_rules) take(other);
  for (const auto& other : more) take(other);
  return rule;
}

std::string rule_part_names(const Case& patient) {
  std::string list;
  for (const auto& part : patient.parts)
    if (collides(part.role)) list += (list.empty() ? "" : ", ") + part.name;
  return list;
}

bool is_rule_part(const Case& patient, const std::string& name) {
  return std::any_of(patient.parts.begin(), patient.parts.end(),
                     [&](const Part& part) { return collides(part.role) && names(name, part); });
}

std::string known_policies() {
  std::string list;
  for (const auto policy :
       {PairPolicy::forbidden, PairPolicy::allowed, PairPolicy::guided, PairPolicy::cut_face})
    list += (list.empty() ? "" : ", ") + policy_name(policy);
  return list;
}

void check_rules(const Case& patient, std::span<const PairRule> rules, const std::string& where) {
  for (const auto& rule : rules) {
    const std::string pair = fmt::format("{} {} and {}: ", where, rule.a, rule.b);
    for (const auto& name : {rule.a, rule.b})
      if (!is_rule_part(patient, name))
        throw InputError(pair + "no bone or teeth are called \"" + name + "\"; there are " +
                         rule_part_names(patient) + ", and * for any");
    if (rule.a == rule.b && rule.a != "*")
      throw InputError(pair + "a pair has two different parts");
    if (rule.gap_mm != 0 && rule.policy != PairPolicy::guided)
      throw InputError(pair + "only guided pairs have a gap, not " + policy_name(rule.policy) +
                       " ones");
    if (rule.margin_mm && rule.policy != PairPolicy::forbidden)
      throw InputError(pair + "only forbidden pairs have a margin, not " +
                       policy_name(rule.policy) + " ones");
    if (rule.margin_mm && !(*rule.margin_mm >= 0 && std::isfinite(*rule.margin_mm)))
      throw InputError(pair +
                       fmt::format("a margin of {} mm; it must be 0 or more", *rule.margin_mm));
    if (!(rule.gap_mm >= 0 && std::isfinite(rule.gap_mm)))
      throw InputError(pair + fmt::format("a gap of {} mm; it must be 0 or more", rule.gap_mm));
  }
}

}  // namespace condyle
