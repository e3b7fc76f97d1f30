#include "sim/muscles/excitations.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_table.h"

namespace condyle {
namespace {

constexpr std::size_t max_bytes = std::size_t{256} << 20;
constexpr double rounding = 1e-3;  // of excitations computed elsewhere: so far beyond 0 and 1

using Names = std::vector<std::string>;

/// What groups are made of: kinds, or other groups.
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

/// Muscles of a kind or group on the side 'l' or 'r', or on both (0).
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

std::vector<std::size_t> muscles_called(std::string name, std::span<const Muscle> muscles) {
  name = lower_case(name);
  for (std::size_t i = 0; i < muscles.size(); ++i)
    if (lower_case(muscles[i].name) == name) return {i};
  if (name.starts_with("bi_")) name.erase(0, 3);
  if (auto both = of_kinds(name, 0, muscles); !both.empty()) return both;
  if (name.size() > 1 && (name[0] == 'l' || name[0] == 'r'))
    return of_kinds(name.substr(1), name[0], muscles);
  return {};
}

std::string known_names(std::span<const Muscle> muscles) {
  std::string text;
  for (const Muscle& muscle : muscles) text += muscle.name + " ";
  text += "and the groups";
  for (const auto& [name, members] : groups()) text += " " + name;
  return text;
}

}  // namespace

std::vector<double> Excitations::at(double time_s) const {
  std::vector<double> values;
  for (const Pchip& curve : of_muscle) values.push_back(std::clamp(curve(time_s), 0.0, 1.0));
  return values;
}

Excitations read_excitations(const std::filesystem::path& file, std::span<const Muscle> muscles) {
  const std::string content = read_file(file, max_bytes);
  TextLines lines(content);
  bool filled = false;
  while ((filled = lines.next_filled()) && trimmed(lines.line()).starts_with('#')) {
  }
  if (!filled) throw InputError(file, "", "the file is empty");
  Names names;
  for (const auto field : fields_of(lines.line(), ',')) names.emplace_back(field);
  const auto time = static_cast<std::size_t>(
      std::find_if(names.begin(), names.end(),
                   [](const std::string& name) { return lower_case(name) == "time_s"; }) -
      names.begin());
  const std::string header = lines.where();
  if (time == names.size())
    throw InputError(file, header,
                     "column time_s is missing; a file of excitations starts with the header "
                     "time_s,MUSCLE,MUSCLE,... (found \"" +
                         shortened(lines.line()) + "\")");
  std::vector<std::vector<std::size_t>> driven(names.size());
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (c == time) continue;
    if (std::count(names.begin(), names.end(), names[c]) > 1)
      throw InputError(file, header, "column " + shortened(names[c]) + " stands twice");
    driven[c] = muscles_called(names[c], muscles);
    if (driven[c].empty())
      throw InputError(file, header,
                       "\"" + shortened(names[c]) + "\" is no muscle of this case; known are " +
                           known_names(muscles));
  }
  if (names.size() < 2) throw InputError(file, header, "no muscle has a column");

  const NumberTable table = read_rows(file, lines, names, ',');
  if (table.rows() == 0) throw InputError(file, "", "there is a header but no excitation");
  check_times(file, table, time);
  std::vector<double> times;
  std::vector<std::vector<double>> sums(muscles.size());
  for (std::size_t r = 0; r < table.rows(); ++r) {
    times.push_back(table.at(r, time) - table.at(0, time));
    for (auto& sum : sums) sum.push_back(0);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const double value = table.at(r, c);
      if (c != time && !(value >= -rounding && value <= 1 + rounding))
        throw InputError(file, table.where(r, c),
                         fmt::format("{} is no excitation; it goes from 0 to 1", value));
      for (const std::size_t m : driven[c]) sums[m].back() += value;
    }
  }
  Excitations out;
  out.duration_s = times.back();
  if (times.size() == 1) times.push_back(1);
  for (auto& sum : sums) {
    if (sum.size() == 1) sum.push_back(sum[0]);
    for (double& value : sum) value = std::clamp(value, 0.0, 1.0);
    out.of_muscle.emplace_back(times, sum);
  }
  return out;
}

}  // namespace condyle
