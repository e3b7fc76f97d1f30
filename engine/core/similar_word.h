#pragma once

#include <span>
#include <string>

namespace condyle {

/// ` (did you mean "opening"?)` where one of the known words differs from `word` by few letters;
/// otherwise empty. Case does not count.
std::string suggestion(const std::string& word, std::span<const std::string> known);

}  // namespace condyle
