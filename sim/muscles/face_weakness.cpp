#include "sim/muscles/face_weakness.h"

#include <fmt/format.h>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
#include "engine/core/text_table.h"

namespace condyle {
namespace {

struct Weakness {
  std::string of;  // a side, a muscle or a kind
  double strength = 0;
};

Weakness parse_weakness(const std::string& spec) {
  const std::string option = "--weakness " + shortened(spec);
  const auto fields = fields_of(spec, ':');
  if (fields.size() != 2 || fields[0].empty())
    throw InputError(option + ": must be left:STRENGTH, right:STRENGTH or MUSCLE:STRENGTH");
  const double strength = parse_number(std::string(fields[1]), "--weakness");
  if (!(strength >= 0 && strength <= 1))
    throw InputError(fmt::format("{}: the strength must be 0 (paralysed) to 1 (healthy), not {}",
                                 option, strength));
  return {std::string(fields[0]), strength};
}

}  // namespace

void check_weakness(std::span<const std::string> specs) {
  for (const std::string& spec : specs) parse_weakness(spec);
}

std::vector<double> muscle_strengths(std::span<const std::string> specs,
                                     std::span<const FaceMuscle> muscles) {
  std::vector<double> strengths(muscles.size(), 1);
  double left = 1, right = 1;
  for (const std::string& spec : specs) {
    const auto [of, strength] = parse_weakness(spec);
    bool found = of == "left" || of == "right";
    if (found) (of == "left" ? left : right) *= strength;
    for (std::size_t m = 0; m < muscles.size() && of != "left" && of != "right"; ++m) {
      if (muscles[m].name != of && muscles[m].kind != of) continue;
      strengths[m] *= strength;
      found = true;
    }
    if (found) continue;
    std::string known;
    for (const FaceMuscle& muscle : muscles) known += ", " + muscle.name;
    throw InputError("--weakness " + shortened(spec) + ": \"" + shortened(of) +
                     "\" is neither a side nor a muscle of the face; valid ones are left, right" +
                     known + ", and names without a side for both");
  }
  for (std::size_t m = 0; m < muscles.size(); ++m)
    strengths[m] *= muscles[m].name.starts_with("left_")    ? left
                    : muscles[m].name.starts_with("right_") ? right
                                                            : 0.5 * (left + right);
  return strengths;
}

}  // namespace condyle
