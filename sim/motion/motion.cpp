#include "sim/motion/motion.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "engine/core/error.h"
#include "sim/motion/opening.h"
#include "sim/motion/recording.h"

namespace condyle {
namespace {

bool looks_like_a_file(const std::string& spec) {
  std::string ending = std::filesystem::path(spec).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::error_code ignored;
  return ending == ".csv" || spec.find('/') != std::string::npos ||
         std::filesystem::exists(spec, ignored);
}

void check(const OpeningSettings& settings) {
  if (!(settings.duration_s > 0 && settings.duration_s <= 3600))
    throw InputError(fmt::format("motion duration {} s: give more than 0 and at most 3600 s",
                                 settings.duration_s));
  if (!(settings.opening_mm >= 0 && settings.opening_mm <= 1000))
    throw InputError(fmt::format("opening {} mm: give 0 (the patient's own) or a positive length",
                                 settings.opening_mm));
  if (!(settings.early_translation <= 1))
    throw InputError(
        fmt::format("early translation {}: give 0 to 1, or a negative value for as early "
                    "as the joint requires",
                    settings.early_translation));
}

}  // namespace

const std::vector<std::string>& builtin_motions() {
  static const std::vector<std::string> names = {"opening", "rest"};
  return names;
}

Motion make_motion(const std::string& spec, const Case& patient, const ContactModel& contacts,
                   const OpeningSettings& settings) {
  check(settings);
  if (spec == "opening") return make_opening(patient, contacts, settings);
  if (spec == "rest") return {spec, settings.duration_s, false, [](double) { return Pose{}; }, {}};
  if (looks_like_a_file(spec)) return read_recording(spec);
  throw InputError(fmt::format("motion \"{}\" is not known: give one of {}, or a pose file (CSV)",
                               spec, fmt::join(builtin_motions(), ", ")));
}

}  // namespace condyle
