#include "sim/appliance/saws.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"

namespace condyle {

const std::vector<Saw>& known_saws() {
  static const char* textbook = "typical of catalogues; measure the blade that is used";
  static const std::vector<Saw> saws = {{"piezo-fine", 0.35, textbook},
                                        {"sagittal", 0.4, textbook},
                                        {"oscillating", 0.5, textbook},
                                        {"piezo", 0.55, textbook},
                                        {"reciprocating", 0.6, textbook},
                                        {"reciprocating-coarse", 0.9, textbook},
                                        {"craniotome", 1.2, "kerf of the vault osteotomies"}};
  return saws;
}

Saw find_saw(const std::string& name_or_mm) {
  std::vector<std::string> names;
  for (const Saw& saw : known_saws()) {
    if (saw.name == name_or_mm) return saw;
    names.push_back(saw.name);
  }
  double mm = 0;
  const char* end = name_or_mm.data() + name_or_mm.size();
  const auto [stop, error] = std::from_chars(name_or_mm.data(), end, mm);
  if (error != std::errc{} || stop != end || name_or_mm.empty())
    throw InputError(fmt::format("unknown saw \"{}\"{}; known are {}, or a thickness in mm",
                                 name_or_mm, suggestion(name_or_mm, names),
                                 fmt::join(names, ", ")));
  if (!(mm >= thinnest_blade_mm && mm <= thickest_blade_mm))
    throw InputError(fmt::format("a saw of {} mm: blades are {} to {} mm thick", name_or_mm,
                                 thinnest_blade_mm, thickest_blade_mm));
  return {fmt::format("{} mm", mm), mm, "given"};
}

}  // namespace condyle
