#include "tools/pair_options.h"

#include <cstdlib>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
#include "sim/case/case_io.h"
#include "sim/case/pair_rules.h"

namespace condyle {
PairRule parse_pair(const std::string& text) {
  constexpr double max_mm = 1000;
  const auto refuse = [&](const std::string& problem) {
    throw InputError("--pair " + text + ": " + problem);
  };
  const std::vector<std::string> fields = split_list(text);
  if (fields.size() < 3)
    refuse("must be A,B,POLICY[,gap=MM][,margin=MM], e.g. skull,mandible,guided,gap=1.5");
  PairRule rule;
  rule.a = fields[0];
  rule.b = fields[1];
  if (const auto policy = policy_named(fields[2]))
    rule.policy = *policy;
  else
    refuse("the policy \"" + fields[2] + "\" is unknown; known are " + known_policies());
  for (std::size_t i = 3; i < fields.size(); ++i) {
    const std::size_t equals = fields[i].find('=');
    const std::string key = fields[i].substr(0, equals);
    if ((key != "gap" && key != "margin") || equals == std::string::npos)
      refuse("\"" + fields[i] + "\" is not known; after the policy come gap=MM and margin=MM");
    const std::string number = fields[i].substr(equals + 1);
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || !(value >= 0 && value <= max_mm))
      refuse("the " + key + " \"" + number + "\" is not a number from 0 to 1000 mm");
    if (key == "gap")
      rule.gap_mm = value;
    else
      rule.margin_mm = value;
  }
  return rule;
}

std::map<std::string, std::string> parse_parents(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> parents;
  for (const auto& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw InputError("--carrier-of " + text +
                       ": must be NAME=mandible, NAME=cranium or NAME=PIECE, e.g. "
                       "segment-2=mandible");
    parents[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return parents;
}

}  // namespace condyle
