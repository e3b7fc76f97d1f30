#include "sim/operation_page/operation_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "engine/core/html_text.h"
#include "sim/frame/part_names.h"
#include "sim/operation/cut_text.h"
#include "sim/osteotomy/osteotomy_label.h"
#include "sim/plan/move.h"

namespace condyle {
namespace {

/// Measures of the profile, which the bones alone do not change.
bool is_soft(const CephalometricMeasure& measure) {
  return measure.name.find("G-Sn-Pog'") != std::string::npos ||
         measure.name.starts_with("nasolabial") || measure.name.find(" lip ") != std::string::npos;
}

std::string signed_number(double value, const char* format) {
  const std::string text = fmt::format(fmt::runtime(format), value);
  return text == "-0.0" || text == "+0.0" ? "0.0" : text;
}

/// "A point", "soft B point": points that cephalometry names by a letter.
std::string point_words(std::string words) {
  for (const auto& [plain, letter] : {std::pair{"a point", "A point"}, {"b point", "B point"}})
    if (const auto at = words.find(plain); at != std::string::npos)
      words.replace(at, std::string_view(plain).size(), letter);
  return words;
}

/// Whether the value after the operation lies outside its norm, as it is printed.
bool is_off(const CephalometricMeasure& measure) {
  return measure.after && measure.norm.sd > 0 &&
         std::abs(*measure.after - measure.norm.mean) > measure.norm.sd + 0.05;
}

std::string clearance_words(const std::optional<ComparedPair::Clearance>& side) {
  if (!side) return "";
  return side->least_mm < -0.005 ? fmt::format("overlap {:.2f} mm", -side->least_mm)
                                 : fmt::format("{:.2f} mm", side->least_mm + 0.0);
}

/// "Le Fort I" of "cut le_fort_1".
std::string cut_words(const std::string& title) {
  constexpr std::string_view cut = "cut ";
  return title.starts_with(cut) ? osteotomy_label(title.substr(cut.size())) : display_name(title);
}

/// An angle in words without the blank before its sign.
std::string angle_words(double degrees, const char* positive, const char* negative) {
  std::string words = in_words(degrees, positive, negative);
  if (const auto blank = words.find(" °"); blank != std::string::npos) words.erase(blank, 1);
  return words;
}

}  // namespace

std::string table_html(const PageTable& table) {
  if (table.rows.empty()) return "";
  constexpr std::size_t short_rows = 14;  // such a table is printed on one page
  std::string html = table.rows.size() <= short_rows ? "<table class=\"short\">\n<thead><tr>"
                                                     : "<table>\n<thead><tr>";
  for (const std::string& cell : table.head) html += "<th>" + escaped(cell) + "</th>";
  html += "</tr></thead>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const bool bad = std::find(table.marked.begin(), table.marked.end(), r) != table.marked.end();
    html += "<tr>";
    for (const std::string& cell : table.rows[r])
      html += (bad ? "<td class=\"bad\">" : "<td>") + escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

PageTable bones_table(const Operated& operated) {
  PageTable table{{"Bone", "Part of", "Volume", "Surface"}, {}};
  for (const BoneSummary& bone : operated_bones(operated))
    table.rows.push_back(
        {display_name(bone.name), bone.is_segment ? readable_name(bone.parent) : "",
         fmt::format("{:.2f} cm³", bone.volume_mm3 / 1000), bone.closed ? "closed" : "open"});
  return table;
}

PageTable movements_table(const MovementTable& movements) {
  PageTable table{{"Point", "Right-left", "Back-forward", "Down-up", "Distance"}, {}};
  const auto mm = [](double value, const char* positive, const char* negative) {
    return in_words(value, positive, negative);
  };
  for (const MovementRow& row : movements.rows)
    table.rows.push_back({row.label, mm(row.left_mm, "left", "right"),
                          mm(row.back_mm, "back", "forward"), mm(row.up_mm, "up", "down"),
                          fmt::format("{:.1f} mm", row.distance_mm())});
  return table;
}

std::string cephalometry_legend(const Operated& operated) {
  std::string text = "* outside its norm.";
  if (!operated.resected_landmarks.empty())
    text += " - not measured, because a landmark is resected.";
  return text + " Norms: published means of European adults with one standard deviation.";
}

PageTable cephalometry_table(const std::vector<CephalometricMeasure>& measures, bool has_soft) {
  PageTable table{{"Measure", "Before", "After", "Change", "Norm"}, {}};
  for (const CephalometricMeasure& measure : measures) {
    if (!measure.before || (is_soft(measure) && !has_soft)) continue;
    const std::string unit = measure.unit == "deg" ? "°" : " " + measure.unit;
    const auto value = [&](const std::optional<double>& number, const char* format) {
      return number ? signed_number(*number, format) : std::string("-");
    };
    table.rows.push_back({measure.name, value(measure.before, "{:.1f}") + unit,
                          value(measure.after, "{:.1f}") + (measure.after ? unit : "") +
                              (is_off(measure) ? " *" : ""),
                          value(measure.change(), "{:+.1f}"), norm_text(measure.norm)});
  }
  return table;
}

PageTable overlaps_table(const std::vector<SegmentOverlap>& overlaps) {
  PageTable table{{"Parts", "Depth", "Volume", "Meaning"}, {}};
  for (const SegmentOverlap& overlap : overlaps)
    table.rows.push_back({display_name(overlap.a) + " and " + readable_name(overlap.b),
                          fmt::format("{:.1f} mm", overlap.depth_mm),
                          fmt::format("{:.0f} mm³", overlap.volume_mm3),
                          overlap.kind == SegmentOverlap::Kind::trimmed    ? "bone to be trimmed"
                          : overlap.kind == SegmentOverlap::Kind::occlusal ? "teeth interfere"
                                                                           : "collision"});
  return table;
}

PageTable ratio_table(const std::vector<SoftRatio>& ratios) {
  PageTable table{{"Soft tissue", "Bone", "Bone moves", "Face moves", "Ratio", "Published"}, {}};
  for (const SoftRatio& ratio : ratios)
    table.rows.push_back({point_words(display_name(ratio.soft)),
                          point_words(readable_name(ratio.hard)),
                          in_words(ratio.hard_mm, "mm forward", "mm back"),
                          in_words(ratio.soft_mm, "mm forward", "mm back"),
                          fmt::format("{:.2f}", ratio.ratio()), published_range(ratio)});
  return table;
}

PageTable rotations_table(const MovementTable& movements) {
  constexpr double least_deg = 0.05;
  PageTable table{{"Segment", "Pitch", "Yaw", "Roll"}, {}};
  for (const SegmentRotation& row : movements.rotations) {
    if (std::abs(row.pitch_deg) < least_deg && std::abs(row.yaw_deg) < least_deg &&
        std::abs(row.roll_deg) < least_deg)
      continue;
    table.rows.push_back({display_name(row.body),
                          angle_words(row.pitch_deg, "° front down", "° front up"),
                          angle_words(row.yaw_deg, "° front to the left", "° front to the right"),
                          angle_words(row.roll_deg, "° left side down", "° right side down")});
  }
  return table;
}

PageTable midlines_table(const MovementTable& movements) {
  PageTable table{{"Midline or cant", "Before", "After"}, {}};
  for (const MidlineRow& row : movements.midlines) {
    const auto words = [&](double mm) {
      return row.is_cant ? in_words(mm, "mm lower on the left", "mm lower on the right")
                         : in_words(mm, "mm to the left", "mm to the right");
    };
    table.rows.push_back({display_name(row.label), words(row.before_mm), words(row.after_mm)});
  }
  return table;
}

PageTable dangers_table(const Operated& operated) {
  PageTable table{{"Structure", "Distance from the cut", "Warned below", "Least margin", "Cut"},
                  {}};
  const auto add = [&](const DangerFinding& finding, const std::string& cut) {
    const bool stop = finding.level == DangerLevel::stop;
    if (stop) table.marked.push_back(table.rows.size());
    table.rows.push_back(
        {display_name(finding.zone),
         finding.distance_mm < 0 ? fmt::format("{:.1f} mm inside", -finding.distance_mm)
                                 : fmt::format("{:.1f} mm", finding.distance_mm),
         fmt::format("{:g} mm", finding.margin.warn_mm),
         fmt::format("{:g} mm{}", finding.margin.stop_mm, stop ? ": not kept" : ""), cut});
  };
  for (const CutReport& cut : operated.cuts)
    for (const DangerFinding& finding : cut.dangers)
      if (finding.level != DangerLevel::clear) add(finding, cut_words(cut.title));
  for (const TrimReport& trim : operated.trims)
    for (const DangerFinding& finding : trim.dangers)
      if (finding.level != DangerLevel::clear) add(finding, display_name(trim.title));
  return table;
}

PageTable soft_points_table(const Prediction& prediction, const ClinicalFrame& frame) {
  PageTable table{{"Point of the face", "Right-left", "Back-forward", "Down-up", "Distance"}, {}};
  for (const SoftPoint& point : prediction.points) {
    const Eigen::Vector3d moved = frame.components(point.after - point.before);
    table.rows.push_back({point_words(display_name(point.landmark)),
                          in_words(moved.x(), "left", "right"),
                          in_words(moved.y(), "back", "forward"), in_words(moved.z(), "up", "down"),
                          fmt::format("{:.1f} mm", moved.norm())});
  }
  return table;
}

PageTable range_of_motion_table(const OperationComparison& comparison) {
  PageTable table{{"Range of motion", "Before", "After"}, {}};
  for (const ComparedMeasure& measure : comparison.measures) {
    const auto words = [&](const std::optional<double>& value) {
      return value ? fmt::format("{:.1f}{}", *value + 0.0,
                                 measure.unit == "deg" ? "°" : " " + measure.unit)
                   : std::string();
    };
    table.rows.push_back({display_name(measure.name), words(measure.before), words(measure.after)});
  }
  return table;
}

PageTable clearances_table(const OperationComparison& comparison) {
  PageTable table{{"Parts", "Before", "After"}, {}};
  for (const ComparedPair& pair : comparison.pairs)
    table.rows.push_back({display_name(pair.a) + " and " + readable_name(pair.b),
                          clearance_words(pair.before), clearance_words(pair.after)});
  return table;
}

}  // namespace condyle
