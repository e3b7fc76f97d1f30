#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "engine/core/error.h"

namespace condyle {

/// A length that shapes a splint or a guide, as its option, its check and its report know it.
template <class Settings>
struct ShapeLength {
  const char* name;  // of the option: "slot-wall"
  double Settings::*value_mm;
  double low, high;
  const char* what;

  std::string words(char between) const {
    std::string text = name;
    std::replace(text.begin(), text.end(), '-', between);
    return text;
  }
};

/// throws: InputError naming the first length that is out of range.
template <class Settings, class Lengths>
void check_lengths(const Settings& settings, const Lengths& lengths) {
  for (const ShapeLength<Settings>& each : lengths)
    if (const double value = settings.*each.value_mm; !(value >= each.low && value <= each.high))
      throw InputError(fmt::format("{} {} mm: it is from {} to {} mm", each.words(' '), value,
                                   each.low, each.high));
}

/// By name: "slot_wall_mm".
template <class Json, class Settings, class Lengths>
Json lengths_json(const Settings& settings, const Lengths& lengths) {
  Json json;
  for (const ShapeLength<Settings>& each : lengths)
    json[each.words('_') + "_mm"] = settings.*each.value_mm;
  return json;
}

}  // namespace condyle
