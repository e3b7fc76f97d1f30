#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/frame/pair_rule.h"
#include "sim/frame/part.h"

namespace condyle {

/// "A,B,POLICY[,gap=MM][,margin=MM]". throws: InputError naming the error.
PairRule parse_pair(const std::string& text);

/// "NAME=BODY" each: the parent body of a piece. throws: InputError.
std::map<std::string, std::string> parse_parents(const std::vector<std::string>& texts);

}  // namespace condyle
