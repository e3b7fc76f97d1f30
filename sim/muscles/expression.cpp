#include "sim/muscles/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_list.h"
#include "engine/core/text_table.h"
#include "sim/case/face_muscle_table.h"

namespace condyle {
namespace {

constexpr double held_until_s = 1;
constexpr std::size_t max_expression_bytes = std::size_t{16} << 20;
constexpr const char* lids_are_drawn =
    "the motion of the upper lids is drawn only; no measurement depends on it";

std::filesystem::path file_of(const std::string& spec) { return spec; }

bool names_file(const std::string& spec) { return lower_case(spec).ends_with(".csv"); }

/// One NAME[:STRENGTH[:left|right]]; `option` begins messages.
ExpressionLevel parse_level(std::string_view text, const std::string& option) {
  const auto fields = fields_of(text, ':');
  const std::string name(fields.empty() ? std::string_view() : fields[0]);
  const NamedExpression* expression = find_expression(name);
  if (!expression)
    throw InputError(option + ": there is no such expression as \"" + shortened(name) +
                     "\"; valid ones are " + list_expressions() + ", or a CSV file (*.csv)");
  double strength = 1;
  if (fields.size() > 1) strength = parse_number(std::string(fields[1]), option);
  if (!(strength >= 0 && strength <= 1))
    throw InputError(fmt::format("{}: the strength must be 0 to 1, not {}", option, strength));
  const std::string_view side = fields.size() > 2 ? fields[2] : std::string_view();
  if (fields.size() > 3 || !(fields.size() < 3 || side == "left" || side == "right"))
    throw InputError(option + ": must be NAME[:STRENGTH[:left|right]]");
  return {.name = expression->name,
          .left = side == "right" ? 0 : strength,
          .right = side == "left" ? 0 : strength};
}

std::vector<ExpressionLevel> parse_levels(const std::string& spec) {
  std::vector<ExpressionLevel> levels;
  for (const auto text : fields_of(spec, '+'))
    levels.push_back(parse_level(text, "--expression " + shortened(spec)));
  return levels;
}

/// A name without its side, and whether it stands for each side.
struct SidedName {
  std::string_view name;
  bool left = true, right = true;
};

SidedName sided_name(std::string_view name) {
  constexpr std::string_view left = "left_", right = "right_";
  if (name.starts_with(left)) return {.name = name.substr(left.size()), .right = false};
  if (name.starts_with(right)) return {.name = name.substr(right.size()), .left = false};
  return {.name = name};
}

/// The level of an expression or action unit by a value of 1 in the column of a file with this
/// name; none: the column is for muscles.
std::optional<ExpressionLevel> level_of_column(std::string_view column) {
  const auto [name, left, right] = sided_name(column);
  const NamedExpression* expression = find_expression(name);
  if (!expression) return std::nullopt;
  return ExpressionLevel{expression->name, left ? 1.0 : 0.0, right ? 1.0 : 0.0};
}

/// What the column of a file with this name excites by a value of 1; none: nothing has the name.
std::optional<FaceExcitation> excited_by(std::string_view column,
                                         std::span<const FaceMuscle> muscles) {
  FaceExcitation excited{.muscles = std::vector<double>(muscles.size(), 0.0)};
  if (const auto [name, left, right] = sided_name(column); is_lid_muscle(name)) {
    (name == lid_closer ? excited.lids : excited.raise) = {left ? 1.0 : 0.0, right ? 1.0 : 0.0};
    return excited;
  }
  bool found = false;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (muscles[m].name != column && muscles[m].kind != column) continue;
    excited.muscles[m] = 1;
    found = true;
  }
  if (found) return excited;
  const std::optional<ExpressionLevel> level = level_of_column(column);
  if (!level) return std::nullopt;
  return excitation_of({&*level, 1}, muscles);
}

[[noreturn]] void refuse_column(const std::filesystem::path& file, const std::string& header,
                                const std::string& column, std::span<const FaceMuscle> muscles) {
  std::string known;
  for (const FaceMuscle& muscle : muscles)
    if (!is_lid_muscle(sided_name(muscle.name).name)) known += muscle.name + ", ";
  throw InputError(
      file, header,
      fmt::format("\"{}\" is not a muscle of the face, expression or action unit; valid ones are "
                  "muscles (without left_ or right_: both sides): {}left_{}, right_{}, left_{}, "
                  "right_{}; expressions, also with left_ or right_: {}",
                  shortened(column), known, lid_closer, lid_closer, lid_raiser, lid_raiser,
                  list_expressions()));
}

/// Adds a level to those of the same name.
void add_level(std::vector<ExpressionLevel>& levels, const ExpressionLevel& level) {
  const auto same = std::find_if(levels.begin(), levels.end(),
                                 [&](const auto& other) { return other.name == level.name; });
  if (same == levels.end()) {
    levels.push_back(level);
  } else {
    same->left = std::max(same->left, level.left);
    same->right = std::max(same->right, level.right);
  }
}

/// The values of a column of a file, and what it excites.
struct ExcitationColumn {
  ExcitationCurve curve;
  FaceExcitation excited;
};

FaceExcitation excitation_by(std::span<const ExcitationColumn> columns, std::size_t muscles,
                             double time_s) {
  FaceExcitation sum{.muscles = std::vector<double>(muscles, 0.0)};
  for (const auto& [curve, excited] : columns)
    sum = added_excitations(std::move(sum), between({.muscles = std::vector<double>(muscles, 0.0)},
                                                    excited, std::clamp(curve(time_s), 0.0, 1.0)));
  return sum;
}

Expression expression_of_file(const std::string& spec, std::span<const FaceMuscle> muscles) {
  const std::filesystem::path file = file_of(spec);
  const std::string text = read_file(file, max_expression_bytes);
  TextLines lines(text);
  if (!lines.next_filled()) throw InputError(file, "", "the file is empty");
  std::vector<std::string> names;
  for (const auto field : fields_of(lines.line(), ',')) names.emplace_back(field);
  const std::string header = lines.where();
  const NumberTable table = read_rows(file, lines, names, ',');
  const auto time =
      static_cast<std::size_t>(std::find(names.begin(), names.end(), "time_s") - names.begin());
  if (time == names.size()) throw InputError(file, header, "there is no column time_s");
  if (table.rows() == 0) throw InputError(file, "", "the file has a header but no excitation");
  check_times(file, table, time);
  std::vector<double> times;
  for (std::size_t row = 0; row < table.rows(); ++row)
    times.push_back(table.at(row, time) - table.at(0, time));
  std::vector<ExcitationColumn> columns;
  std::vector<ExpressionLevel> levels;  // of the columns for expressions that are not 0 throughout
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (c == time) continue;
    std::optional<FaceExcitation> excited = excited_by(names[c], muscles);
    if (!excited) refuse_column(file, header, names[c], muscles);
    std::vector<double> values;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const double value = table.at(row, c);
      if (!(value >= 0 && value <= 1))
        throw InputError(file, table.where(row, c),
                         fmt::format("an excitation must be 0 to 1, not {}", value));
      values.push_back(value);
    }
    if (const auto level = level_of_column(names[c]);
        level && *std::max_element(values.begin(), values.end()) > 0)
      add_level(levels, *level);
    columns.push_back(
        {ExcitationCurve(times, std::move(values), Interpolation::smooth), std::move(*excited)});
  }
  const bool moves_lids = std::any_of(columns.begin(), columns.end(), [](const auto& column) {
    return column.excited.moves_lids();
  });
  std::vector<std::string> notes;
  if (std::string missing = missing_kinds(levels, muscles); !missing.empty())
    notes.push_back(std::move(missing));
  if (moves_lids) notes.emplace_back(lids_are_drawn);
  return {.name = file.filename().string(),
          .duration_s = times.back(),
          .at = [columns = std::move(columns), count = muscles.size()](
                    double time_s) { return excitation_by(columns, count, time_s); },
          .notes = std::move(notes)};
}

}  // namespace

Expression expression_through(std::string name, std::span<const ExpressionKey> keys,
                              std::span<const FaceMuscle> muscles) {
  std::vector<double> times;
  std::vector<FaceExcitation> values;
  std::vector<std::string> notes;
  for (const ExpressionKey& key : keys) {
    const std::string missing = missing_kinds(key.levels, muscles);
    if (!missing.empty() && std::find(notes.begin(), notes.end(), missing) == notes.end())
      notes.push_back(missing);
    times.push_back(key.time_s);
    values.push_back(excitation_of(key.levels, muscles));
  }
  if (std::any_of(values.begin(), values.end(),
                  [](const FaceExcitation& value) { return value.moves_lids(); }))
    notes.emplace_back(lids_are_drawn);
  const double end_s = times.back();
  return {.name = std::move(name),
          .duration_s = end_s,
          .at =
              [times = std::move(times), values = std::move(values)](double time_s) {
                const auto next = static_cast<std::size_t>(
                    std::upper_bound(times.begin(), times.end(), time_s) - times.begin());
                if (next == 0) return values.front();
                if (next == times.size()) return values.back();
                const double u = (time_s - times[next - 1]) / (times[next] - times[next - 1]);
                const double s = u * u * (3 - 2 * u);
                return between(values[next - 1], values[next], s);
              },
          .notes = std::move(notes)};
}

void check_expression(const std::string& spec) {
  if (!names_file(spec))
    parse_levels(spec);
  else if (!std::filesystem::is_regular_file(file_of(spec)))
    throw InputError(file_of(spec), "", "there is no such file");
}

bool expression_moves_upper_face(const std::string& spec) {
  if (!names_file(spec)) return moves_upper_face(parse_levels(spec));
  const std::string text = read_file(file_of(spec), max_expression_bytes);
  TextLines lines(text);
  if (!lines.next_filled()) return false;
  const auto names = fields_of(lines.line(), ',');
  return std::any_of(names.begin(), names.end(), [](std::string_view column) {
    const std::string_view name = sided_name(column).name;
    const ExpressionLevel level{.name = std::string(name), .left = 1};
    return pulls_upper_face(level.name) || moves_upper_face({&level, 1});
  });
}

Expression make_expression(const std::string& spec, std::span<const FaceMuscle> muscles) {
  if (names_file(spec)) return expression_of_file(spec, muscles);
  const std::vector<ExpressionLevel> levels = parse_levels(spec);
  const ExpressionKey keys[] = {
      {.time_s = 0}, {.time_s = expression_onset_s, .levels = levels}, {held_until_s, levels}};
  return expression_through(spec, keys, muscles);
}

}  // namespace condyle
