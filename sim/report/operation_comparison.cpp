#include "sim/report/operation_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/core/html_text.h"
#include "sim/frame/part_names.h"
#include "sim/motion/measure_pose.h"
#include "sim/report/motion_extremes.h"
#include "sim/report/plots.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

/// What a surgeon reads as range of motion; speeds are inputs of a motion.
constexpr const char* range_of_motion[] = {"opening",
                                           "between_incisors",
                                           "protrusion",
                                           "laterotrusion_left",
                                           "laterotrusion_right",
                                           "rotation",
                                           "left_condyle_travel",
                                           "right_condyle_travel",
                                           "condyle_asymmetry"};

/// The motion as prescribed, at the frames of a check.
MotionSeries prescribed_series(const Scene& scene, const Motion& motion,
                               const ClearanceCheck& check) {
  const MotionSampler sampler(scene, motion, 1.0 / 120);
  MotionSeries series(scene, motion);
  for (const double time : check.time_s) {
    FrameState frame = rest_frame(scene);
    frame.time_s = time;
    frame.poses = sampler.poses(time);
    frame.measures = measure(scene.patient, frame.poses);
    series.add(frame);
  }
  return series;
}

ComparedPair::Clearance clearance_of(const PairVerdict& pair) {
  ComparedPair::Clearance result;
  result.violated = pair.violated();
  if (!pair.clearance_mm.empty()) {
    result.at_rest_mm = pair.clearance_mm.front();
    result.least_mm = *std::min_element(pair.clearance_mm.begin(), pair.clearance_mm.end());
  }
  result.least_mm = std::min(result.least_mm, pair.worst.sample.signed_distance_mm());
  return result;
}

ComparedPair& pair_in(std::vector<ComparedPair>& pairs, const PairVerdict& verdict) {
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const ComparedPair& pair) {
    return (pair.a == verdict.a && pair.b == verdict.b) ||
           (pair.a == verdict.b && pair.b == verdict.a);
  });
  if (found != pairs.end()) return *found;
  return pairs.emplace_back(ComparedPair{verdict.a, verdict.b, std::nullopt, std::nullopt});
}

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", *value + 0.0) : "-";
}

std::optional<double> least_of(const std::optional<ComparedPair::Clearance>& side) {
  return side ? std::optional(side->least_mm) : std::nullopt;
}

std::string verdict_of(const std::optional<ComparedPair::Clearance>& side) {
  return side && side->violated ? "*" : "";
}

Json json_of(const std::optional<ComparedPair::Clearance>& side) {
  if (!side) return nullptr;
  return {
      {"least_mm", side->least_mm}, {"at_rest_mm", side->at_rest_mm}, {"violated", side->violated}};
}

}  // namespace

OperationComparison compare_operation(const Scene& before, const Motion& motion_before,
                                      const ClearanceCheck& check_before, const Scene& after,
                                      const Motion& motion_after,
                                      const ClearanceCheck& check_after) {
  OperationComparison comparison;
  const auto was = prescribed_series(before, motion_before, check_before);
  const auto is = prescribed_series(after, motion_after, check_after);
  const auto largest_before = extremes(was), largest_after = extremes(is);
  const auto value = [](const MotionSeries& series, const std::vector<Extreme>& all,
                        const char* name) -> std::optional<double> {
    if (!series.known_landmarks || all.empty()) return std::nullopt;
    return extreme(all, name).value;
  };
  for (const char* name : range_of_motion)
    comparison.measures.push_back({name, std::string(name) == "rotation" ? "deg" : "mm",
                                   value(was, largest_before, name),
                                   value(is, largest_after, name)});
  for (const PairVerdict& pair : check_after.pairs)
    pair_in(comparison.pairs, pair).after = clearance_of(pair);
  for (const PairVerdict& pair : check_before.pairs)
    pair_in(comparison.pairs, pair).before = clearance_of(pair);
  return comparison;
}

Json OperationComparison::json() const {
  Json json;
  json["range_of_motion"] = Json::array();
  for (const ComparedMeasure& measure : measures) {
    Json row = {{"name", measure.name}, {"unit", measure.unit}};
    row["before"] = measure.before ? Json(*measure.before) : Json(nullptr);
    row["after"] = measure.after ? Json(*measure.after) : Json(nullptr);
    json["range_of_motion"].push_back(std::move(row));
  }
  json["pairs"] = Json::array();
  for (const ComparedPair& pair : pairs)
    json["pairs"].push_back({{"a", pair.a},
                             {"b", pair.b},
                             {"before", json_of(pair.before)},
                             {"after", json_of(pair.after)}});
  return json;
}

std::string OperationComparison::html() const {
  std::string html =
      "<h2>Before and after the operation</h2>\n<table>\n<tr><th>Range of motion</th>"
      "<th>Before</th><th>After</th></tr>\n";
  const auto unit_of = [](const ComparedMeasure& measure, const std::optional<double>& value) {
    return value ? number(value) + (measure.unit == "deg" ? "°" : " " + measure.unit) : "";
  };
  for (const ComparedMeasure& measure : measures)
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        escaped(display_name(measure.name)), unit_of(measure, measure.before),
                        unit_of(measure, measure.after));
  html += "</table>\n<table>\n<tr><th>Least distance</th><th>Before</th><th>After</th></tr>\n";
  const auto cell = [](const std::optional<ComparedPair::Clearance>& side) -> std::string {
    if (!side) return "<td></td>";
    return fmt::format("<td{}>{}</td>", side->violated ? " class=\"bad\"" : "",
                       side->least_mm < -0.005 ? fmt::format("overlap {:.2f} mm", -side->least_mm)
                                               : fmt::format("{:.2f} mm", side->least_mm + 0.0));
  };
  for (const ComparedPair& pair : pairs)
    html += fmt::format("<tr><td>{} and {}</td>{}{}</tr>\n", escaped(display_name(pair.a)),
                        escaped(readable_name(pair.b)), cell(pair.before), cell(pair.after));
  return html +
         "</table>\n<p class=\"small\">During the same motion. Overlap of segments of one bone is "
         "bone that the surgeon trims.</p>\n";
}

std::string OperationComparison::text() const {
  std::string text = fmt::format("{:<34}{:>10}{:>10}\n", "Range of motion", "before", "after");
  for (const ComparedMeasure& measure : measures)
    text += fmt::format("{:<34}{:>10}{:>10} {}\n", display_name(measure.name),
                        number(measure.before), number(measure.after), measure.unit);
  text += fmt::format("{:<34}{:>10}{:>10}\n", "Least distance, or overlap (negative)", "", "");
  for (const ComparedPair& pair : pairs)
    text += fmt::format("{:<34}{:>10}{:>10} mm\n",
                        display_name(pair.a) + " and " + readable_name(pair.b),
                        number(least_of(pair.before)) + verdict_of(pair.before),
                        number(least_of(pair.after)) + verdict_of(pair.after));
  return text + "* violates the rule of the pair\n";
}

}  // namespace condyle
