#include "sim/case/face_muscle_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/infinity.h"
#include "engine/core/text_table.h"
#include "sim/case/table_row.h"

namespace condyle {
namespace {

constexpr std::size_t max_face_bytes = std::size_t{16} << 20;
constexpr std::size_t max_face_points = 100'000;
constexpr double face_reach_mm = 1000, strongest_face_N = 200, most_shortening = 0.6;
constexpr double most_spread_mm = 30, same_point_mm = 0.01;

/// Kinds and their abbreviations in published models.
const std::vector<std::pair<const char*, const char*>>& face_kinds() {
  static const std::vector<std::pair<const char*, const char*>> all = {
      {"zygomaticus_major", "zyg"},
      {"zygomaticus_minor", "zmi"},
      {"levator_labii_superioris", "lls"},
      {"levator_labii_alaeque_nasi", "llsan"},
      {"levator_anguli_oris", "lao"},
      {"risorius", "ris"},
      {"buccinator", "buc"},
      {"orbicularis_oris_marginal", "oom"},
      {"orbicularis_oris_peripheral", "oop"},
      {"depressor_anguli_oris", "dao"},
      {"depressor_labii_inferioris", "dli"},
      {"mentalis", "ment"},
      {"orbicularis_oculi", "oco"},
      {"orbicularis_oculi_superior", "ocs"},
      {"frontalis_medial", "frm"},
      {"frontalis_lateral", "frl"},
      {"corrugator", "cor"},
      {"procerus", "pro"},
  };
  return all;
}

std::map<std::string, std::size_t> face_columns(const std::filesystem::path& file,
                                                const TextLines& lines) {
  std::map<std::string, std::size_t> columns;
  const auto fields = fields_of(lines.line(), ',');
  for (std::size_t c = 0; c < fields.size(); ++c)
    if (!columns.emplace(std::string(fields[c]), c).second)
      throw InputError(file, lines.where(),
                       fmt::format("column {} appears twice", shortened(fields[c])));
  for (const char* name : {"muscle", "side", "fibre", "point", "x_mm", "y_mm", "z_mm"})
    if (!columns.contains(name))
      throw InputError(file, lines.where(),
                       fmt::format("column {} is missing; a table of the muscles of the face "
                                   "starts with the header muscle,side,fibre,point,x_mm,y_mm,z_mm "
                                   "(found \"{}\")",
                                   name, shortened(lines.line())));
  return columns;
}

std::vector<std::string> unused_columns(const std::map<std::string, std::size_t>& columns) {
  static const std::set<std::string> known = {
      "muscle", "full_name", "side",  "fibre",     "point", "x_mm",       "y_mm",
      "z_mm",   "body",      "depth", "spread_mm", "law",   "shortening", "max_force_N"};
  std::vector<std::string> unused;
  for (const auto& column : columns)
    if (!known.contains(column.first)) unused.push_back(column.first);
  return unused;
}

std::string kind_of(const TableRow& row) {
  const std::string given = lower_case(row.text("muscle"));
  for (const auto& [kind, abbreviation] : face_kinds())
    if (given == kind || given == abbreviation) return kind;
  const bool plain = std::all_of(given.begin(), given.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
  if (given.empty() || !plain)
    row.refuse("muscle", "\"" + shortened(row.text("muscle")) +
                             "\" is no name of a muscle: use letters, digits, - and _");
  return given;
}

FaceMusclePoint point_of(const TableRow& row) {
  FaceMusclePoint point{.depth = std::nullopt};
  constexpr std::array<const char*, 3> axes = {"x_mm", "y_mm", "z_mm"};
  for (int k = 0; k < 3; ++k)
    point.at[k] = row.number(axes[static_cast<std::size_t>(k)], -face_reach_mm, face_reach_mm);
  using Bone = std::optional<BodyId>;
  point.bone = row.chosen<Bone>("body", {{"", Bone()},
                                         {"tissue", Bone()},
                                         {"cranium", cranium_body},
                                         {"maxilla", cranium_body},
                                         {"mandible", mandible_body},
                                         {"jaw", mandible_body}});
  if (!row.text("depth").empty()) point.depth = row.number("depth", 0, 1);
  point.spread_mm = row.number_or("spread_mm", 0, 0, most_spread_mm);
  return point;
}

/// Muscles in the order of their first rows.
class FaceTableReader {
 public:
  FaceTableReader(const std::filesystem::path& file, ZeroStrength zero)
      : file_(file), zero_(zero) {}

  void add(const TableRow& row) {
    const std::string kind = kind_of(row);
    const auto side = row.chosen<const char*>(
        "side", {{"left", "left"}, {"right", "right"}, {"both", ""}, {"", ""}});
    const std::string name = *side ? std::string(side) + "_" + kind : kind;
    FaceMuscle& muscle = muscle_called(name, kind, row);
    const std::string fibre = row.text("fibre");
    if (name != last_name_ || fibre != last_fibre_) {
      if (!fibres_.insert({name, fibre}).second)
        row.refuse("fibre", "\"" + shortened(fibre) + "\" of " + name +
                                " appears twice; the rows of a fibre must follow one another");
      muscle.lines.emplace_back();
      last_name_ = name, last_fibre_ = fibre;
      last_number_ = -1;
    }
    const double number = row.number("point", 0, static_cast<double>(max_face_points));
    if (!(number > last_number_))
      row.refuse("point", fmt::format("{} does not follow {}", number, last_number_));
    last_number_ = number;
    const FaceMusclePoint point = point_of(row);
    auto& line = muscle.lines.back();
    if (!line.empty() && (line.back().at - point.at).norm() < same_point_mm)
      row.refuse("x_mm", "the point lies where the one before it does");
    if (line.size() > 1 && line.back().bone)
      row.refuse("body", "only the ends of a fibre can be on bones; the point before is on one");
    line.push_back(point);
  }

  std::vector<FaceMuscle> muscles() && {
    if (muscles_.empty()) throw InputError(file_, "", "the file has a header but no muscle");
    for (const FaceMuscle& muscle : muscles_)
      for (const auto& line : muscle.lines)
        if (line.size() < 2)
          throw InputError(file_, muscle.name, "a fibre has one point; it needs two or more");
    return std::move(muscles_);
  }

 private:
  /// A new muscle, or that of earlier rows if they agree.
  FaceMuscle& muscle_called(const std::string& name, const std::string& kind, const TableRow& row) {
    FaceMuscle muscle{.name = name, .kind = kind, .lines = {}};
    for (const char* column : {"max_force_N", "shortening"})
      if (zero_ == ZeroStrength::refused && !row.text(column).empty() &&
          !(row.number(column, 0, infinity) > 0))
        row.refuse(column, "must be above 0; leave it empty for that of the muscle's kind");
    muscle.limit_N = row.number_or("max_force_N", 0, 0, strongest_face_N);
    muscle.shortening = row.number_or("shortening", 0, 0, most_shortening);
    muscle.law = row.chosen<FaceMuscleLaw>("law", {{"", FaceMuscleLaw::bounded},
                                                   {"bounded", FaceMuscleLaw::bounded},
                                                   {"hill", FaceMuscleLaw::hill}});
    const auto found = std::find_if(muscles_.begin(), muscles_.end(),
                                    [&](const FaceMuscle& other) { return other.name == name; });
    if (found == muscles_.end()) {
      for (const auto& [column, value] :
           {std::pair("max_force_N", muscle.limit_N), std::pair("shortening", muscle.shortening)})
        if (value <= 0 && !is_face_muscle_kind(kind))
          row.refuse(column, "of " + name + " is needed, above 0: it is of no known kind");
      return muscles_.emplace_back(std::move(muscle));
    }
    for (const auto& [column, same] :
         {std::pair("max_force_N", found->limit_N == muscle.limit_N),
          std::pair("shortening", found->shortening == muscle.shortening),
          std::pair("law", found->law == muscle.law)})
      if (!same)
        row.refuse(column, "\"" + shortened(row.text(column)) + "\" differs from earlier rows of " +
                               name + "; it is of the whole muscle");
    return *found;
  }

  const std::filesystem::path& file_;
  ZeroStrength zero_;
  std::vector<FaceMuscle> muscles_;
  std::set<std::pair<std::string, std::string>> fibres_;
  std::string last_name_, last_fibre_;
  double last_number_ = -1;
};

}  // namespace

bool is_face_muscle_kind(const std::string& kind) {
  return std::any_of(face_kinds().begin(), face_kinds().end(),
                     [&](const auto& known) { return kind == known.first; });
}

bool pulls_upper_face(const std::string& kind) {
  constexpr std::array<std::string_view, 5> upper = {"orbicularis_oculi_superior",
                                                     "frontalis_medial", "frontalis_lateral",
                                                     "corrugator", "procerus"};
  return std::find(upper.begin(), upper.end(), kind) != upper.end();
}

std::string face_muscle_side(const FaceMuscle& muscle) {
  for (const char* side : {"left", "right"})
    if (muscle.name == std::string(side) + "_" + muscle.kind) return side;
  return "both";
}

FaceMuscleTable read_face_muscles(const std::filesystem::path& file, ZeroStrength zero) {
  const std::string content = read_file(file, max_face_bytes);
  TextLines lines(content);
  if (!lines.next_filled()) throw InputError(file, "", "the file is empty");
  const auto columns = face_columns(file, lines);
  FaceTableReader reader(file, zero);
  for (std::size_t rows = 0; lines.next_filled(); ++rows) {
    if (rows == max_face_points)
      throw InputError(file, lines.where(), fmt::format("more than {} points", max_face_points));
    reader.add(TableRow(file, lines, columns));
  }
  return {.muscles = std::move(reader).muscles(),
          .has_bodies = columns.contains("body"),
          .unused_columns = unused_columns(columns)};
}

std::string face_muscles_csv(const std::vector<FaceMuscle>& muscles) {
  std::string text =
      "muscle,side,fibre,point,x_mm,y_mm,z_mm,body,depth,spread_mm,max_force_N,shortening,law\n";
  const auto of_muscle = [](double value) {  // 0: that of its kind
    return value > 0 ? fmt::format("{}", value) : "";
  };
  for (const FaceMuscle& m : muscles)
    for (std::size_t fibre = 0; fibre < m.lines.size(); ++fibre)
      for (std::size_t i = 0; i < m.lines[fibre].size(); ++i) {
        const FaceMusclePoint& p = m.lines[fibre][i];
        const char* body = !p.bone ? "tissue" : *p.bone == cranium_body ? "cranium" : "mandible";
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", m.kind, face_muscle_side(m),
                            fibre + 1, i, p.at.x(), p.at.y(), p.at.z(), body,
                            p.depth ? fmt::format("{}", *p.depth) : "", p.spread_mm,
                            of_muscle(m.limit_N), of_muscle(m.shortening),
                            m.law == FaceMuscleLaw::hill ? "hill" : "bounded");
      }
  return text;
}

}  // namespace condyle
