#include <fmt/format.h>

#include <algorithm>

#include "sim/comparison/plan_comparison.h"
#include "sim/plan/columns.h"
#include "sim/plan/move.h"

namespace condyle {
namespace {

/// "left 0.4", "0.0": directions first would not align.
std::string side_words(double mm) { return in_words(mm, "left", "right"); }
std::string depth_words(double mm) { return in_words(mm, "forward", "back"); }
std::string height_words(double mm) { return in_words(mm, "up", "down"); }

}  // namespace

std::string plan_comparison_text(const PlanComparison& comparison) {
  const bool fitted = std::any_of(comparison.segments.begin(), comparison.segments.end(),
                                  [](const auto& segment) { return segment.rms_mm > 0; });
  std::string text = fmt::format("{} relative to {}\n\n", comparison.second, comparison.first);
  std::vector<std::vector<std::string>> rows = {{"segment, mm and degrees", "right-left",
                                                 "back-forward", "down-up", "distance", "yaw",
                                                 "pitch", "roll", "angle", "accepted"}};
  for (const SegmentDifference& row : comparison.segments)
    rows.push_back({row.body, side_words(row.left_mm), depth_words(row.forward_mm),
                    height_words(row.up_mm), fmt::format("{:.1f}", row.distance_mm()),
                    in_words(row.yaw_deg, "left", "right"),
                    in_words(row.pitch_deg, "front down", "front up"),
                    in_words(row.roll_deg, "left side down", "right side down"),
                    fmt::format("{:.1f}", row.angle_deg), row.accepted() ? "yes" : "no"});
  if (fitted) {
    rows[0].push_back("fit RMS");
    for (std::size_t i = 1; i < rows.size(); ++i)
      rows[i].push_back(fmt::format("{:.2f}", comparison.segments[i - 1].rms_mm));
  }
  text += aligned_columns(rows, fitted ? "llllrlllrlr" : "llllrlllrl");
  text += fmt::format("Accepted: within {:g} mm and {:g} degrees.\n", accepted_mm, accepted_deg);
  if (comparison.landmarks.empty()) return text;
  rows = {{"landmark, mm", "right-left", "back-forward", "down-up", "distance"}};
  for (const LandmarkDifference& row : comparison.landmarks)
    rows.push_back({row.label, side_words(row.left_mm), depth_words(row.forward_mm),
                    height_words(row.up_mm), fmt::format("{:.1f}", row.distance_mm())});
  return text + "\n" + aligned_columns(rows, "llllr");
}

nlohmann::ordered_json plan_comparison_json(const PlanComparison& comparison) {
  using Json = nlohmann::ordered_json;
  Json json = {{"first", comparison.first},  {"second", comparison.second},
               {"accepted_mm", accepted_mm}, {"accepted_deg", accepted_deg},
               {"segments", Json::array()},  {"landmarks", Json::array()},
               {"notes", comparison.notes}};
  for (const SegmentDifference& row : comparison.segments)
    json["segments"].push_back({{"name", row.body},
                                {"left_mm", row.left_mm},
                                {"forward_mm", row.forward_mm},
                                {"up_mm", row.up_mm},
                                {"distance_mm", row.distance_mm()},
                                {"yaw_deg", row.yaw_deg},
                                {"pitch_deg", row.pitch_deg},
                                {"roll_deg", row.roll_deg},
                                {"angle_deg", row.angle_deg},
                                {"accepted", row.accepted()},
                                {"registration_rms_mm", row.rms_mm}});
  for (const LandmarkDifference& row : comparison.landmarks)
    json["landmarks"].push_back({{"label", row.label},
                                 {"landmark", row.landmark},
                                 {"left_mm", row.left_mm},
                                 {"forward_mm", row.forward_mm},
                                 {"up_mm", row.up_mm},
                                 {"distance_mm", row.distance_mm()}});
  return json;
}

}  // namespace condyle
