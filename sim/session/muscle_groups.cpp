#include "sim/session/muscle_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

constexpr double rise_s = 0.1, held_until_s = 0.6, end_s = 1.2;

}  // namespace

const std::vector<MuscleGroup>& muscle_groups() {
  static const std::vector<MuscleGroup> groups = {
      {"lt", "Temporalis, left", {"lat", "lmt", "lpt"}, 0},
      {"rt", "Temporalis, right", {"rat", "rmt", "rpt"}, 0},
      {"lm", "Masseter, left", {"ldm", "lsm"}, 0},
      {"rm", "Masseter, right", {"rdm", "rsm"}, 0},
      {"lmp", "Medial pterygoid, left", {"lmp"}, 0},
      {"rmp", "Medial pterygoid, right", {"rmp"}, 0},
      {"llp", "Lateral pterygoid, left", {"lip", "lsp"}, 0.15},
      {"rlp", "Lateral pterygoid, right", {"rip", "rsp"}, 0.15},
      {"hopen",
       "Digastric and floor of the mouth",
       {"lad", "rad", "lam", "ram", "lpm", "rpm", "lgh", "rgh"},
       0.15},
  };
  return groups;
}

double excitation_of(const MotionChoice& choice, const std::string& group, double otherwise) {
  const auto found = choice.excitations.find(group);
  return found == choice.excitations.end() ? otherwise : found->second;
}

std::string held_excitations(const MotionChoice& choice) {
  std::string head = "time_s", none, full;
  for (const auto& group : muscle_groups()) {
    head += std::string(",") + group.name;
    none += ",0";
    full += fmt::format(",{:.4f}", excitation_of(choice, group.name, group.default_excitation));
  }
  return fmt::format("{}\n0{}\n{}{}\n{}{}\n{}{}\n{}{}\n", head, none, rise_s, full, held_until_s,
                     full, held_until_s + rise_s, none, end_s, none);
}

double held_at_s() { return (rise_s + held_until_s) / 2; }

std::string scaled_excitations(const Motion& base, const MotionChoice& choice) {
  constexpr double each_s = 0.01;
  std::vector<double> fractions(base.muscle_names.size(), 1.0);
  std::string text = "time_s";
  for (std::size_t m = 0; m < base.muscle_names.size(); ++m) {
    text += "," + base.muscle_names[m];
    for (const auto& group : muscle_groups())
      for (const char* name : group.muscles)
        if (base.muscle_names[m] == name) fractions[m] = excitation_of(choice, group.name, 1);
  }
  text += "\n";
  const long rows = std::lround(base.duration_s / each_s);
  for (long r = 0; r <= rows; ++r) {
    const double time_s = std::min(static_cast<double>(r) * each_s, base.duration_s);
    text += fmt::format("{:.3f}", time_s);
    const MuscleStates states = base.muscles(time_s);
    for (std::size_t m = 0; m < states.size(); ++m)
      text += fmt::format(",{:.6f}", std::min(1.0, fractions[m] * states[m].excitation));
    text += "\n";
  }
  return text;
}

}  // namespace condyle
