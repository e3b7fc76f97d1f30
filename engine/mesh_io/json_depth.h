#pragma once

#include <algorithm>
#include <string_view>

namespace condyle {

/// Deepest nesting of lists and objects that the program's JSON files need. Parsing or copying
/// deeper texts could overflow the stack.
constexpr int max_json_depth = 64;

/// Nesting depth of the lists and objects of a JSON text.
inline int json_depth(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

}  // namespace condyle
