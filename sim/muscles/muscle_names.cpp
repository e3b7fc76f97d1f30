#include "sim/muscles/muscle_names.h"

#include <array>
#include <map>
#include <set>
#include <sstream>

#include "engine/core/text_table.h"

namespace condyle {
namespace {

using Names = std::vector<std::string>;

/// Members of each group: kinds, or other groups.
const std::map<std::string, Names>& groups() {
  static const std::map<std::string, Names> table = {
      {"t", {"at", "mt", "pt"}},
      {"m", {"dm", "sm"}},
      {"my", {"am", "pm"}},
      {"lp", {"ip", "sp"}},
      {"close", {"t", "m", "mp"}},
      {"hopen", {"ad", "my", "gh"}},
      {"pro", {"lp"}},
      {"open", {"hopen", "pro"}},
      {"stiffenjaw", {"open", "close"}},
      {"protracthyoid", {"ad", "gh", "my"}},
      {"retracthyoid", {"pd", "sh"}},
      {"suprahyoid", {"ad", "gh", "my", "pd", "sh"}},
      {"infrahyoid", {"th", "stet", "steh", "oh"}},
  };
  return table;
}

void add_kinds(const std::string& name, std::set<std::string>& kinds) {
  const auto group = groups().find(name);
  if (group == groups().end()) {
    kinds.insert(name);
    return;
  }
  for (const auto& member : group->second) add_kinds(member, kinds);
}

/// Muscles of a kind or group on side 'l' or 'r', or on both sides (0).
std::vector<std::size_t> of_kinds(const std::string& name, char side,
                                  std::span<const Muscle> muscles) {
  std::set<std::string> kinds;
  add_kinds(name, kinds);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < muscles.size(); ++i) {
    const std::string kind = lower_case(muscles[i].kind);
    if (!kinds.contains(kind)) continue;
    if (side == 0 || lower_case(muscles[i].name) == side + kind) found.push_back(i);
  }
  return found;
}

}  // namespace

std::vector<std::size_t> muscles_named(std::string_view called, std::span<const Muscle> muscles) {
  std::string name = lower_case(called);
  for (std::size_t i = 0; i < muscles.size(); ++i)
    if (lower_case(muscles[i].name) == name) return {i};
  if (name.starts_with("bi_")) name.erase(0, 3);
  if (auto both = of_kinds(name, 0, muscles); !both.empty()) return both;
  if (name.size() > 1 && (name[0] == 'l' || name[0] == 'r'))
    return of_kinds(name.substr(1), name[0], muscles);
  return {};
}

std::string short_name(const Muscle& muscle) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> shorter = {
      {{"Anterior", "Ant."},
       {"Posterior", "Post."},
       {"Superior", "Sup."},
       {"Inferior", "Inf."},
       {"Medial", "Med."},
       {"Lateral", "Lat."},
       {"Superficial", "Superf."}}};
  std::string words;
  std::istringstream full(muscle.full_name.empty() ? muscle.name : muscle.full_name);
  for (std::string word; full >> word;) {
    for (const auto& [whole, few] : shorter)
      if (word == whole) word = few;
    words += (words.empty() ? "" : " ") + word;
  }
  const char side = muscle.name.empty() ? ' ' : muscle.name.front();
  return (side == 'l' ? "L " : side == 'r' ? "R " : "") + words;
}

std::string list_muscle_names(std::span<const Muscle> muscles) {
  std::string text;
  for (const Muscle& muscle : muscles) text += muscle.name + " ";
  text += "and the groups";
  for (const auto& [name, members] : groups()) text += " " + name;
  return text;
}

}  // namespace condyle
