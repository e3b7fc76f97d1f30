#include "sim/muscles/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_list.h"
#include "engine/core/text_table.h"

namespace condyle {
namespace {

constexpr double onset_s = 0.5, held_until_s = 1;

/// Excitation of a kind of muscle, on both sides.
struct KindExcitation {
  const char* kind;
  double value;
};
struct BuiltinExpression {
  const char* name;
  std::vector<KindExcitation> kinds;
};

/// Brows and lids have no muscles yet.
const std::vector<BuiltinExpression>& builtin_list() {
  static const std::vector<BuiltinExpression> all = {
      {"smile",
       {{"zygomaticus_major", 1},
        {"zygomaticus_minor", 0.5},
        {"levator_labii_superioris", 0.3},
        {"risorius", 0.3}}},
      {"open-mouth-smile",
       {{"zygomaticus_major", 1},
        {"zygomaticus_minor", 0.5},
        {"levator_labii_superioris", 0.5},
        {"risorius", 0.3},
        {"depressor_labii_inferioris", 0.4}}},
      {"sad", {{"depressor_anguli_oris", 0.8}, {"mentalis", 0.3}}},
      {"disgust", {{"levator_labii_alaeque_nasi", 0.8}, {"levator_labii_superioris", 0.6}}},
  };
  return all;
}

struct BuiltinSpec {
  const BuiltinExpression* expression = nullptr;
  double strength = 1;
  std::string side;  // empty: both
};

std::filesystem::path file_of(const std::string& spec) { return spec; }

bool names_file(const std::string& spec) { return lower_case(spec).ends_with(".csv"); }

BuiltinSpec parse_builtin(const std::string& spec) {
  const std::string option = "--expression " + shortened(spec);
  const auto fields = fields_of(spec, ':');
  BuiltinSpec parsed;
  for (const BuiltinExpression& each : builtin_list())
    if (!fields.empty() && fields[0] == each.name) parsed.expression = &each;
  if (!parsed.expression) {
    std::string known;
    for (const auto& name : builtin_expressions()) known += name + ", ";
    throw InputError(option + ": there is no such expression; valid ones are " + known +
                     "or a CSV file (*.csv)");
  }
  if (fields.size() > 1) parsed.strength = parse_number(std::string(fields[1]), "--expression");
  if (!(parsed.strength >= 0 && parsed.strength <= 1))
    throw InputError(
        fmt::format("{}: the strength must be 0 to 1, not {}", option, parsed.strength));
  if (fields.size() > 2) parsed.side = fields[2];
  if (fields.size() > 3 ||
      !(parsed.side.empty() || parsed.side == "left" || parsed.side == "right"))
    throw InputError(option + ": must be NAME[:STRENGTH[:left|right]]");
  return parsed;
}

std::vector<std::size_t> muscles_called(std::string_view name,
                                        std::span<const FaceMuscle> muscles) {
  std::vector<std::size_t> found;
  for (std::size_t m = 0; m < muscles.size(); ++m)
    if (muscles[m].name == name || muscles[m].kind == name) found.push_back(m);
  return found;
}

Expression builtin_expression(const std::string& spec, std::span<const FaceMuscle> muscles) {
  const BuiltinSpec parsed = parse_builtin(spec);
  const std::string other = parsed.side.empty() ? "" : parsed.side == "left" ? "right_" : "left_";
  Expression made{
      .name = spec, .duration_s = held_until_s, .muscles = muscles.size(), .channels = {}};
  for (const auto& [kind, value] : parsed.expression->kinds) {
    std::vector<std::size_t> excited = muscles_called(kind, muscles);
    std::erase_if(excited, [&](std::size_t m) {
      return !other.empty() && muscles[m].name.starts_with(other);
    });
    made.channels.push_back(
        {ExcitationCurve({0, onset_s}, {0, value * parsed.strength}, Interpolation::cubic),
         std::move(excited)});
  }
  return made;
}

Expression expression_of_file(const std::string& spec, std::span<const FaceMuscle> muscles) {
  constexpr std::size_t max_expression_bytes = std::size_t{16} << 20;
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
  Expression made{.name = file.filename().string(),
                  .duration_s = times.back(),
                  .muscles = muscles.size(),
                  .channels = {}};
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (c == time) continue;
    std::vector<std::size_t> excited = muscles_called(names[c], muscles);
    if (excited.empty()) {
      std::string known;
      for (const FaceMuscle& muscle : muscles) known += (known.empty() ? "" : ", ") + muscle.name;
      throw InputError(file, header,
                       "\"" + shortened(names[c]) + "\" is not a muscle of the face; valid ones, " +
                           "also without left_ or right_ for both sides, are " + known);
    }
    std::vector<double> values;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const double value = table.at(row, c);
      if (!(value >= 0 && value <= 1))
        throw InputError(file, table.where(row, c),
                         fmt::format("an excitation must be 0 to 1, not {}", value));
      values.push_back(value);
    }
    made.channels.push_back(
        {ExcitationCurve(times, std::move(values), Interpolation::smooth), std::move(excited)});
  }
  return made;
}

}  // namespace

std::vector<double> Expression::at(double time_s) const {
  std::vector<double> values(muscles, 0.0);
  for (const Channel& channel : channels) {
    const double value = channel.curve(time_s);
    for (const std::size_t m : channel.muscles) values[m] += value;
  }
  for (double& value : values) value = std::clamp(value, 0.0, 1.0);
  return values;
}

std::vector<std::string> builtin_expressions() {
  std::vector<std::string> names;
  for (const BuiltinExpression& each : builtin_list()) names.emplace_back(each.name);
  return names;
}

void check_expression(const std::string& spec) {
  if (!names_file(spec))
    parse_builtin(spec);
  else if (!std::filesystem::is_regular_file(file_of(spec)))
    throw InputError(file_of(spec), "", "there is no such file");
}

Expression make_expression(const std::string& spec, std::span<const FaceMuscle> muscles) {
  return names_file(spec) ? expression_of_file(spec, muscles) : builtin_expression(spec, muscles);
}

}  // namespace condyle
