#include "sim/muscles/excitations.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_table.h"
#include "sim/case/json_file.h"
#include "sim/muscles/muscle_names.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

constexpr std::size_t max_bytes = std::size_t{256} << 20, max_sidecar_bytes = std::size_t{1} << 20;
constexpr double rounding = 1e-3;  // tolerated excess beyond 0 and 1 in files of other programs
constexpr double dip = 0.05;       // tolerated negative values of cubic knots; clamped to 0

const std::array<std::pair<std::string_view, Interpolation>, 4> words = {
    {{"step", Interpolation::step},
     {"linear", Interpolation::linear},
     {"smooth", Interpolation::smooth},
     {"cubic", Interpolation::cubic}}};

std::optional<Interpolation> interpolation_named(std::string_view word) {
  for (const auto& [name, kind] : words)
    if (lower_case(word) == name) return kind;
  return std::nullopt;
}

std::string unknown_interpolation(std::string_view word) {
  std::string known;
  for (const auto& [name, kind] : words) known += (known.empty() ? "" : ", ") + std::string(name);
  return "\"" + shortened(word) + "\" is not an interpolation; valid ones are " + known;
}

/// Reads one file for the muscles of a case.
class Reader {
 public:
  Reader(const fs::path& file, std::span<const Muscle> muscles)
      : file_(file),
        muscles_(muscles),
        kept_(muscles.begin(), muscles.end()),
        text_(read_file(file, max_bytes)),
        lines_(text_) {}

  Excitations read() {
    if (const auto sidecar = sidecar_of(file_)) read_sidecar(*sidecar);
    if (out_.tone.empty()) out_.tone.assign(kept_.size(), 0.0);
    find_header();
    if (const auto muscle = column("muscle"))
      read_knots(*muscle);
    else
      read_columns();
    out_.duration_s = until_s_.value_or(out_.duration_s);
    return std::move(out_);
  }

 private:
  void read_sidecar(const fs::path& sidecar) {
    const JsonFile json(sidecar, read_file(sidecar, max_sidecar_bytes));
    const JsonItem root = json.root();
    root.only_keys({"interpolation", "tone", "without", "until_s"});
    if (const auto item = root.find("until_s")) until_s_ = item->number(0.001, 3600);
    if (const auto item = root.find("interpolation")) {
      interpolation_ = interpolation_named(item->text());
      if (!interpolation_) item->refuse(unknown_interpolation(item->text()));
    }
    if (const auto list = root.find("without")) {
      std::vector<bool> out(muscles_.size(), false);
      for (std::size_t i = 0; i < list->size(); ++i)
        for (const std::size_t m : called(list->at(i), list->at(i).text(), muscles_)) out[m] = true;
      kept_.clear();
      for (std::size_t m = 0; m < muscles_.size(); ++m)
        if (out[m])
          out_.without.push_back(muscles_[m].name);
        else
          kept_.push_back(muscles_[m]);
      if (kept_.empty()) list->refuse("leaves no muscle");
    }
    out_.tone.assign(kept_.size(), 0.0);
    if (const auto tones = root.find("tone")) {
      if (!tones->value().is_object()) tones->refuse("must be an object {\"MUSCLE\": 0.001, ...}");
      for (const auto& [name, value] : tones->value().items()) {
        const JsonItem item = tones->at(name);
        for (const std::size_t m : called(item, name, kept_)) out_.tone[m] += item.number(0, 1);
      }
    }
  }
  static std::vector<std::size_t> called(const JsonItem& item, const std::string& name,
                                         std::span<const Muscle> among) {
    auto found = muscles_named(name, among);
    if (found.empty())
      item.refuse("\"" + shortened(name) + "\" is not a muscle of this case; its muscles are " +
                  list_muscle_names(among));
    return found;
  }

  void find_header() {
    bool filled = false;
    while ((filled = lines_.next_filled()) && trimmed(lines_.line()).starts_with('#')) {
      const auto fields = fields_of(trimmed(lines_.line()).substr(1), ':');
      if (fields.size() != 2 || lower_case(fields[0]) != "interpolation" || interpolation_)
        continue;
      interpolation_ = interpolation_named(fields[1]);
      if (!interpolation_)
        throw InputError(file_, lines_.where(), unknown_interpolation(fields[1]));
    }
    if (!filled) throw InputError(file_, "", "the file is empty");
    for (const auto field : fields_of(lines_.line(), ',')) names_.emplace_back(field);
    header_ = lines_.where();
    for (const auto& name : names_)
      if (std::count(names_.begin(), names_.end(), name) > 1)
        throw InputError(file_, header_, "column " + shortened(name) + " appears twice");
  }
  std::optional<std::size_t> column(std::string_view name) const {
    for (std::size_t c = 0; c < names_.size(); ++c)
      if (lower_case(names_[c]) == name) return c;
    return std::nullopt;
  }
  std::optional<std::size_t> column_like(std::string_view begin) const {
    for (std::size_t c = 0; c < names_.size(); ++c)
      if (lower_case(names_[c]).starts_with(begin)) return c;
    return std::nullopt;
  }
  std::size_t needed_column(std::string_view name, const char* shape) const {
    if (const auto found = column(name)) return *found;
    throw InputError(file_, header_,
                     fmt::format("column {} is missing; {} (found \"{}\")", name, shape,
                                 shortened(lines_.line())));
  }

  /// Muscles of that name that are not removed.
  std::vector<std::size_t> driven(std::string_view name, const std::string& where) const {
    auto found = muscles_named(name, kept_);
    if (found.empty() && muscles_named(name, muscles_).empty())
      throw InputError(file_, where,
                       "\"" + shortened(name) +
                           "\" is not a muscle of this case; its muscles are " +
                           list_muscle_names(muscles_));
    return found;
  }
  void check(double value, const std::string& where, double below = rounding) const {
    if (!(value >= -below && value <= 1 + rounding))
      throw InputError(file_, where,
                       fmt::format("{} is not an excitation; the range is 0 to 1", value));
  }

  void read_columns() {
    const std::size_t time = needed_column(
        "time_s", "an excitation file starts with the header time_s,MUSCLE,MUSCLE,...");
    std::vector<std::vector<std::size_t>> of_column(names_.size());
    for (std::size_t c = 0; c < names_.size(); ++c)
      if (c != time) of_column[c] = driven(names_[c], header_);
    if (names_.size() < 2) throw InputError(file_, header_, "no column names a muscle");
    const NumberTable table = read_rows(file_, lines_, names_, ',');
    if (table.rows() == 0) throw InputError(file_, "", "the file has a header but no excitation");
    check_times(file_, table, time);
    std::vector<double> times;
    for (std::size_t r = 0; r < table.rows(); ++r)
      times.push_back(table.at(r, time) - table.at(0, time));
    out_.duration_s = times.back();
    for (std::size_t c = 0; c < names_.size(); ++c) {
      if (c == time) continue;
      std::vector<double> values;
      for (std::size_t r = 0; r < table.rows(); ++r) {
        check(table.at(r, c), table.where(r, c));
        values.push_back(table.at(r, c));
      }
      out_.channels.push_back(
          {ExcitationCurve(times, values, interpolation_.value_or(Interpolation::smooth)),
           of_column[c]});
    }
  }

  void read_knots(std::size_t muscle) {
    const char* shape = "a file of knots has the header muscle,time_s,excitation";
    const std::size_t time = needed_column("time_s", shape),
                      excitation = needed_column("excitation", shape);
    const auto interpolation = column("interpolation"), active = column_like("active");
    struct Knots {
      std::string name;
      Interpolation kind;
      std::vector<std::size_t> muscles;
      std::vector<double> times, values;
    };
    std::vector<Knots> all;
    while (lines_.next_filled()) {
      const auto fields = fields_of(lines_.line(), ',');
      if (fields.size() != names_.size())
        throw InputError(
            file_, lines_.where(),
            fmt::format("has {} columns; the header has {}", fields.size(), names_.size()));
      const auto where = [&](std::size_t c) { return lines_.where() + ", " + names_[c]; };
      const double t = parse_number(file_, where(time), fields[time]);
      const double value = parse_number(file_, where(excitation), fields[excitation]);
      if (active && parse_number(file_, where(*active), fields[*active]) == 0) continue;
      check(value, where(excitation), dip);
      Interpolation kind = interpolation_.value_or(Interpolation::smooth);
      if (interpolation && !interpolation_) {
        const auto named = interpolation_named(fields[*interpolation]);
        if (!named)
          throw InputError(file_, where(*interpolation),
                           unknown_interpolation(fields[*interpolation]));
        kind = *named;
      }
      auto found = std::find_if(all.begin(), all.end(),
                                [&](const Knots& k) { return k.name == fields[muscle]; });
      if (found == all.end()) {
        all.push_back(
            {std::string(fields[muscle]), kind, driven(fields[muscle], where(muscle)), {}, {}});
        found = all.end() - 1;
      }
      if (found->kind != kind)
        throw InputError(
            file_, where(*interpolation),
            fmt::format("{} has a different interpolation than in earlier rows; use one per muscle",
                        found->name));
      if (t < 0 || (!found->times.empty() && !(t > found->times.back())))
        throw InputError(file_, where(time),
                         found->times.empty()
                             ? fmt::format("{} is before the start, 0", t)
                             : fmt::format("{} is not later than {}", t, found->times.back()));
      found->times.push_back(t);
      found->values.push_back(value);
      out_.duration_s = std::max(out_.duration_s, t);
    }
    if (all.empty()) throw InputError(file_, "", "the file has a header but no excitation");
    for (auto& knots : all)
      out_.channels.push_back(
          {ExcitationCurve(std::move(knots.times), std::move(knots.values), knots.kind),
           std::move(knots.muscles)});
  }

  const fs::path& file_;
  std::span<const Muscle> muscles_;
  std::vector<Muscle> kept_;
  std::string text_;
  TextLines lines_;
  Names names_;
  std::string header_;
  std::optional<Interpolation> interpolation_;  // for the whole file
  std::optional<double> until_s_;
  Excitations out_;
};

}  // namespace

std::vector<double> Excitations::at(double time_s) const {
  std::vector<double> values = tone;
  for (const Channel& channel : channels) {
    const double value = std::max(channel.curve(time_s), 0.0);
    for (const std::size_t m : channel.muscles) values[m] += value;
  }
  for (double& value : values) value = std::clamp(value, 0.0, 1.0);
  return values;
}

Excitations read_excitations(const fs::path& file, std::span<const Muscle> muscles) {
  return Reader(file, muscles).read();
}

}  // namespace condyle
