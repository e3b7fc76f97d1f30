#include "sim/frame/pair_rule.h"

#include <array>
#include <utility>

namespace condyle {
namespace {

constexpr std::array<std::pair<PairPolicy, const char*>, 4> policies = {{
    {PairPolicy::forbidden, "forbidden"},
    {PairPolicy::allowed, "allowed"},
    {PairPolicy::guided, "guided"},
    {PairPolicy::cut_face, "cut-face"},
}};

}  // namespace

PairRule default_rule(const BodyTree& bodies, const Part& a, const Part& b) {
  PairRule rule{a.name, b.name, PairPolicy::forbidden, std::nullopt, 0};
  if (is_teeth(a.role) && is_teeth(b.role)) rule.policy = PairPolicy::allowed;
  if (bodies.link(a.body, b.body) == BodyLink::cut) rule.policy = PairPolicy::cut_face;
  return rule;
}

std::string policy_name(PairPolicy policy) {
  for (const auto& [known, name] : policies)
    if (known == policy) return name;
  return "";
}

std::optional<PairPolicy> policy_named(const std::string& name) {
  for (const auto& [policy, known] : policies)
    if (name == known) return policy;
  return std::nullopt;
}

}  // namespace condyle
