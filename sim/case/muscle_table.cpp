#include "sim/case/muscle_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_table.h"
#include "sim/case/table_row.h"

namespace condyle {
namespace {

constexpr std::size_t max_muscle_bytes = std::size_t{16} << 20;
constexpr std::size_t max_muscles = 1000;
constexpr double farthest_mm = 1000, strongest_N = 2000;
constexpr double default_stretch = 1.3, default_passive = 0.015;
constexpr double min_length_mm = 1;

const std::array<const char*, 7> needed_numbers = {"ox_mm", "oy_mm", "oz_mm",      "ix_mm",
                                                   "iy_mm", "iz_mm", "max_force_N"};

/// Bodies by name; absent value: valid, but not simulated.
std::optional<std::optional<MuscleBody>> body_named(const std::string& name) {
  using B = MuscleBody;
  static const std::map<std::string, std::optional<MuscleBody>> names = {
      {"cranium", B::cranium}, {"maxilla", B::cranium},   {"skull", B::cranium},
      {"jaw", B::mandible},    {"mandible", B::mandible}, {"hyoid", B::hyoid},
      {"thyroid", B::neck},    {"cricoid", B::neck},      {"sternum", B::neck},
      {"neck", B::neck},       {"ltarytenoid", {}},       {"rtarytenoid", {}}};
  const auto found = names.find(name);
  if (found == names.end()) return std::nullopt;
  return found->second;
}

const char* body_name(MuscleBody body) {
  switch (body) {
    case MuscleBody::cranium:
      return "cranium";
    case MuscleBody::mandible:
      return "mandible";
    case MuscleBody::hyoid:
      return "hyoid";
    default:
      return "neck";
  }
}

std::map<std::string, std::size_t> read_header(const std::filesystem::path& file,
                                               const TextLines& lines) {
  std::map<std::string, std::size_t> columns;
  const auto fields = fields_of(lines.line(), ',');
  for (std::size_t c = 0; c < fields.size(); ++c)
    if (!columns.emplace(std::string(fields[c]), c).second)
      throw InputError(file, "line 1",
                       fmt::format("column {} appears twice", shortened(fields[c])));
  std::vector<std::string> needed = {"name", "origin_body", "insertion_body"};
  for (const char* name : needed_numbers) needed.emplace_back(name);
  for (const auto& name : needed)
    if (!columns.contains(name))
      throw InputError(file, "line 1",
                       fmt::format("column {} is missing; a muscle table starts with the header "
                                   "name,origin_body,insertion_body,ox_mm,oy_mm,oz_mm,ix_mm,iy_mm,"
                                   "iz_mm,max_force_N (found \"{}\")",
                                   name, shortened(lines.line())));
  return columns;
}

/// Absent for a muscle of bodies that are not simulated.
std::optional<Muscle> read_muscle(const TableRow& row) {
  Muscle m;
  m.name = row.text("name");
  if (m.name.empty()) row.refuse("name", "is empty");
  m.kind = row.text("abbrev").empty() ? m.name : row.text("abbrev");
  m.full_name = row.text("full_name");
  m.group = row.text("group");
  for (auto [column, body] :
       {std::pair{"origin_body", &m.origin_body}, std::pair{"insertion_body", &m.insertion_body}}) {
    const auto known = body_named(lower_case(row.text(column)));
    if (!known)
      row.refuse(column,
                 "\"" + shortened(row.text(column)) +
                     "\" is not a body; valid ones are cranium, maxilla, jaw, hyoid, thyroid, "
                     "cricoid, sternum, neck");
    if (!*known) return std::nullopt;
    *body = **known;
  }
  for (int k = 0; k < 3; ++k) {
    m.origin[k] =
        row.number(needed_numbers[static_cast<std::size_t>(k)], -farthest_mm, farthest_mm);
    m.insertion[k] =
        row.number(needed_numbers[static_cast<std::size_t>(k + 3)], -farthest_mm, farthest_mm);
  }
  const double rest = (m.origin - m.insertion).norm();
  if (rest < min_length_mm)
    row.refuse("ox_mm", fmt::format("the muscle {} is {:.3g} mm long; its ends coincide",
                                    shortened(m.name), rest));
  m.max_force_N = row.number("max_force_N", 0, strongest_N);
  m.optimal_length_mm = row.number_or("opt_length_mm", rest, min_length_mm, farthest_mm);
  m.max_length_mm = row.number_or("max_length_mm", default_stretch * m.optimal_length_mm,
                                  min_length_mm, farthest_mm);
  if (!(m.max_length_mm > m.optimal_length_mm))
    row.refuse("max_length_mm", fmt::format("{} is not above the optimal length, {}",
                                            m.max_length_mm, m.optimal_length_mm));
  m.tendon_ratio = row.number_or("tendon_ratio", 0, 0, 0.95);
  m.passive_fraction = row.number_or("passive_fraction", default_passive, 0, 1);
  if (m.origin_body == m.insertion_body ||
      (!m.moves(MuscleBody::mandible) && !m.moves(MuscleBody::hyoid)))
    return std::nullopt;
  return m;
}

}  // namespace

std::vector<Muscle> read_muscles(const std::filesystem::path& file,
                                 std::vector<std::string>& notes) {
  const std::string content = read_file(file, max_muscle_bytes);
  TextLines lines(content);
  if (!lines.next_filled()) throw InputError(file, "", "the file is empty");
  const auto columns = read_header(file, lines);
  std::vector<Muscle> muscles;
  std::set<std::string> names;
  std::string left_out;
  int idle = 0;
  while (lines.next_filled()) {
    const TableRow row(file, lines, columns);
    const auto muscle = read_muscle(row);
    const std::string name = row.text("name");
    if (!names.insert(name).second)
      row.refuse("name", "the muscle \"" + shortened(name) + "\" appears twice");
    if (names.size() > max_muscles)
      throw InputError(file, lines.where(), fmt::format("more than {} muscles", max_muscles));
    if (muscle) {
      muscles.push_back(*muscle);
    } else {
      left_out += (idle++ ? ", " : "") + name;
    }
  }
  if (muscles.empty())
    throw InputError(file, "",
                     names.empty() ? "the file has a header but no muscle"
                                   : "none of its muscles moves the mandible or the hyoid");
  if (idle > 0)
    notes.push_back(fmt::format("muscles: {} that move neither mandible nor hyoid are omitted: {}",
                                idle, left_out));
  return muscles;
}

std::string muscles_csv(const std::vector<Muscle>& muscles) {
  std::string text =
      "name,abbrev,full_name,group,origin_body,insertion_body,ox_mm,oy_mm,oz_mm,ix_mm,iy_mm,iz_mm,"
      "max_force_N,opt_length_mm,max_length_mm,tendon_ratio,passive_fraction\n";
  for (const Muscle& m : muscles)
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", m.name, m.kind,
                        m.full_name, m.group, body_name(m.origin_body), body_name(m.insertion_body),
                        m.origin.x(), m.origin.y(), m.origin.z(), m.insertion.x(), m.insertion.y(),
                        m.insertion.z(), m.max_force_N, m.optimal_length_mm, m.max_length_mm,
                        m.tendon_ratio, m.passive_fraction);
  return text;
}

}  // namespace condyle
