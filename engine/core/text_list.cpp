#include "engine/core/text_list.h"

#include <cmath>
#include <cstdlib>

#include "engine/core/error.h"

namespace condyle {

std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> items(1);
  for (const char c : text)
    if (c == ',')
      items.emplace_back();
    else
      items.back() += c;
  return items;
}

double parse_number(const std::string& text, const std::string& option) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value))
    throw InputError(option + ": \"" + text + "\" is no number");
  return value;
}

}  // namespace condyle
