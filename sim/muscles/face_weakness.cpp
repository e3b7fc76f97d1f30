#include "sim/muscles/face_weakness.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
#include "engine/core/text_table.h"
#include "sim/muscles/expression_names.h"

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

FaceStrengths muscle_strengths(std::span<const std::string> specs,
                               std::span<const FaceMuscle> muscles) {
  const std::string lids(lid_closer), left_lids = "left_" + lids, right_lids = "right_" + lids;
  FaceStrengths strengths{.muscles = std::vector<double>(muscles.size(), 1)};
  double left = 1, right = 1;
  for (const std::string& spec : specs) {
    const auto [of, strength] = parse_weakness(spec);
    bool found = of == "left" || of == "right";
    if (found) (of == "left" ? left : right) *= strength;
    for (std::size_t m = 0; m < muscles.size() && of != "left" && of != "right"; ++m) {
      if (muscles[m].name != of && muscles[m].kind != of) continue;
      strengths.muscles[m] *= strength;
      found = true;
    }
    if (of == lids || of == left_lids) strengths.lids.left *= strength, found = true;
    if (of == lids || of == right_lids) strengths.lids.right *= strength, found = true;
    if (found) continue;
    std::string known;
    for (const FaceMuscle& muscle : muscles) known += ", " + muscle.name;
    throw InputError("--weakness " + shortened(spec) + ": \"" + shortened(of) +
                     "\" is neither a side nor a muscle of the face; valid ones are left, right" +
                     known + ", " + left_lids + ", " + right_lids +
                     ", and names without a side for both");
  }
  for (std::size_t m = 0; m < muscles.size(); ++m)
    strengths.muscles[m] *= muscles[m].name.starts_with("left_")    ? left
                            : muscles[m].name.starts_with("right_") ? right
                                                                    : 0.5 * (left + right);
  strengths.lids.left *= left;
  strengths.lids.right *= right;
  return strengths;
}

FaceExcitation weakened(FaceExcitation healthy, const FaceStrengths& strengths) {
  const std::size_t count = std::min(healthy.muscles.size(), strengths.muscles.size());
  for (std::size_t m = 0; m < count; ++m) healthy.muscles[m] *= strengths.muscles[m];
  healthy.lids = strengths.lids * healthy.lids;
  return healthy;
}

}  // namespace condyle
