#include "sim/report/expression_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

const Finding* finding_named(const std::vector<Finding>& list, const std::string& name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Finding& one) { return one.name == name; });
  return found == list.end() ? nullptr : &*found;
}

Json tooth_json(const ToothShow& tooth) {
  Json json = {{"show_mm", tooth.show_mm}};
  if (tooth.crown_mm) {
    json["crown_mm"] = *tooth.crown_mm;
    json["crown_fraction"] = *tooth.crown_fraction();
    json["gum_mm"] = *tooth.gum_mm();
  }
  return json;
}

Json teeth_json(const ExpressionMeasures& measures) {
  Json json;
  if (measures.now.line) json["smile_line"] = name_of(*measures.now.line);
  for (std::size_t i = 0; i < measures.now.teeth.size(); ++i)
    json["teeth"].push_back({{"fdi", measures.now.teeth[i].fdi},
                             {"at_rest", tooth_json(measures.at_rest.teeth[i])},
                             {"now", tooth_json(measures.now.teeth[i])}});
  return json;
}

/// Measures of each tooth as findings without ranges.
std::vector<Finding> with_teeth(const ExpressionMeasures& measures) {
  std::vector<Finding> all = measures.findings;
  for (const auto& [what, state] :
       {std::pair(" at rest", &measures.at_rest), std::pair("", &measures.now)})
    for (const ToothShow& tooth : state->teeth) {
      const auto add = [&](const char* quantity, const std::optional<double>& value) {
        if (value)
          all.push_back({.name = fmt::format("tooth {}: {}{}", tooth.fdi, quantity, what),
                         .unit = "mm",
                         .value = *value,
                         .low = 1,
                         .published = {}});
      };
      add("show", tooth.show_mm);
      add("gum show", tooth.gum_mm());
    }
  return all;
}

}  // namespace

Json expression_json(const ExpressionMeasures& measures, const ExpressionMeasures* before) {
  Json json = teeth_json(measures);
  if (!before) return json;
  json["before"] = teeth_json(*before);
  for (const Finding& finding : before->findings)
    json["before"]["findings"].push_back(
        {{"quantity", finding.name}, {"value", finding.value}, {"unit", finding.unit}});
  return json;
}

std::string expression_csv(const ExpressionMeasures& measures, const ExpressionMeasures* before) {
  std::string text = "quantity,unit,value,low,high,published";
  text += before ? ",before\n" : "\n";
  const std::vector<Finding> earlier = before ? with_teeth(*before) : std::vector<Finding>{};
  for (const Finding& finding : with_teeth(measures)) {
    text += fmt::format("\"{}\",{},{:.3f},", finding.name, finding.unit, finding.value);
    text += finding.banded() ? fmt::format("{:g},{:g},", finding.low, finding.high) : ",,";
    text += fmt::format("\"{}\"", finding.published);
    if (const Finding* was = finding_named(earlier, finding.name))
      text += fmt::format(",{:.3f}", was->value);
    else if (before)
      text += ",";
    text += "\n";
  }
  return text;
}

std::string expression_text(const ExpressionMeasures& measures, const ExpressionMeasures* before) {
  if (measures.findings.empty()) return "";
  std::size_t width = 0;
  for (const Finding& finding : measures.findings) width = std::max(width, finding.name.size());
  const auto row = [&](const std::string& name, const std::string& was, const std::string& is,
                       const std::string& more) {
    return fmt::format("  {:<{}}  {}{:>9}  {}\n", name, width,
                       before ? fmt::format("{:>9}  ", was) : "", is, more);
  };
  std::string text = row("expression", "before", before ? "after" : "", "");
  for (const Finding& finding : measures.findings) {
    const Finding* was = before ? finding_named(before->findings, finding.name) : nullptr;
    text += row(
        finding.name, was ? fmt::format("{:.2f}", was->value) : "",
        fmt::format("{:.2f}", finding.value),
        finding.unit +
            (finding.banded() ? fmt::format(" ({:g} to {:g})", finding.low, finding.high) : ""));
  }
  if (measures.now.line)
    text += row("smile line", before && before->now.line ? name_of(*before->now.line) : "",
                name_of(*measures.now.line), "");
  return text;
}

}  // namespace condyle
