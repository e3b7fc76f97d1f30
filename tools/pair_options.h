#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/frame/pair_rule.h"
#include "sim/frame/part.h"

namespace condyle {

/// "A,B,POLICY[,gap=MM][,margin=MM]". throws: InputError naming what is wrong with it.
PairRule parse_pair(const std::string& text);

/// "NAME=mandible" or "NAME=cranium" each. throws: InputError.
std::map<std::string, Body> parse_carriers(const std::vector<std::string>& texts);

}  // namespace condyle
