#pragma once

#include <string>
#include <vector>

namespace condyle {

/// The items of "a,b,c"; an empty text is one empty item.
std::vector<std::string> split_list(const std::string& text);

/// throws: InputError naming the option unless the whole text is a finite number.
double parse_number(const std::string& text, const std::string& option);

}  // namespace condyle
