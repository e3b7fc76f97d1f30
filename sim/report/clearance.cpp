#include "sim/report/clearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sim/motion/measures.h"

namespace condyle {

bool ClearanceCheck::violated() const {
  return std::any_of(pairs.begin(), pairs.end(), [](const PairVerdict& pair) {
    return pair.violates_margin || pair.penetrates;
  });
}

ClearanceCheck check_clearance(const Scene& scene, const Motion& motion, double margin_mm,
                               const SimulatorSettings& settings, const Progress& progress) {
  ClearanceCheck check;
  const auto& parts = scene.patient.parts;
  for (const auto& rest : scene.contacts.at_rest().pairs) {
    const auto& a = parts[static_cast<std::size_t>(rest.part_a)];
    const auto& b = parts[static_cast<std::size_t>(rest.part_b)];
    check.pairs.push_back({.a = a.name,
                           .b = b.name,
                           .teeth = is_teeth(a.role) && is_teeth(b.role),
                           .rest_distance_mm = rest.touching ? 0 : rest.distance_mm,
                           .rest_depth_mm = rest.rest_depth_mm,
                           .least_distance_mm = 1e300});
  }
  check.pairs_csv =
      "frame,time_s,opening_mm,a,b,touching,distance_mm,depth_mm,beyond_rest_mm,contacts,"
      "witness_a_x_mm,witness_a_y_mm,witness_a_z_mm,witness_b_x_mm,witness_b_y_mm,witness_b_z_mm\n";
  check.frames = static_cast<int>(std::lround(motion.duration_s / settings.step_s)) + 1;
  ContactSet previous = scene.contacts.at_rest();
  for (int frame = 0; frame < check.frames; ++frame) {
    const double time = std::min(frame * settings.step_s, motion.duration_s);
    const Pose X_CM = motion.wanted(time);
    ContactSet now = scene.contacts.find(X_CM, &previous, settings.threads);
    const Measures measures = measure(scene.patient, X_CM);
    check.opening_mm.push_back(measures.opening_mm);
    check.rotation_deg.push_back(measures.rotation_deg);
    for (std::size_t i = 0; i < now.pairs.size(); ++i) {
      const auto& pair = now.pairs[i];
      auto& verdict = check.pairs[i];
      const double distance = pair.touching ? 0 : pair.distance_mm;
      const double beyond = pair.depth_mm - pair.rest_depth_mm;
      if (distance < verdict.least_distance_mm) {
        verdict.least_distance_mm = distance;
        verdict.least_frame = frame;
      }
      if (beyond > verdict.beyond_rest_mm) {
        verdict.beyond_rest_mm = beyond;
        verdict.deepest_frame = frame;
      }
      if (pair.touching) {
        if (verdict.first_touch < 0) verdict.first_touch = frame;
        ++verdict.touching_frames;
      }
      fmt::format_to(std::back_inserter(check.pairs_csv),
                     "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", frame, time,
                     measures.opening_mm, verdict.a, verdict.b, pair.touching ? 1 : 0, distance,
                     pair.depth_mm, std::max(0.0, beyond), pair.contacts.size(), pair.witness_a.x(),
                     pair.witness_a.y(), pair.witness_a.z(), pair.witness_b.x(), pair.witness_b.y(),
                     pair.witness_b.z());
    }
    previous = std::move(now);
    report(progress, "checking", (frame + 1.0) / check.frames);
  }
  for (auto& verdict : check.pairs) {
    verdict.penetrates = verdict.beyond_rest_mm > settings.contact.slack_mm;
    // Bones apart at rest must not touch at all: a thin shell gives no depth to measure.
    if (verdict.rest_depth_mm == 0 && verdict.rest_distance_mm > 0 && verdict.touching_frames > 0)
      verdict.penetrates = true;
    verdict.violates_margin = !verdict.teeth && verdict.least_distance_mm < margin_mm;
  }
  return check;
}

std::string ClearanceCheck::json(const Scene& scene, const Motion& motion, double margin_mm) const {
  nlohmann::ordered_json json = {
      {"about", "Condyle; for research and education, not for clinical use"},
      {"case", scene.patient.name},
      {"motion", {{"name", motion.name}, {"duration_s", motion.duration_s}}},
      {"margin_mm", margin_mm},
      {"frames", frames},
      {"violation", violated()},
      {"max_opening_mm", *std::max_element(opening_mm.begin(), opening_mm.end())},
      {"pairs", nlohmann::ordered_json::array()}};
  for (const auto& pair : pairs) {
    const auto at = [&](int frame) {
      const auto f = static_cast<std::size_t>(frame);
      return nlohmann::ordered_json{
          {"frame", frame}, {"opening_mm", opening_mm[f]}, {"rotation_deg", rotation_deg[f]}};
    };
    nlohmann::ordered_json entry = {{"a", pair.a},
                                    {"b", pair.b},
                                    {"policy", pair.teeth ? "allowed contact" : "forbidden"},
                                    {"distance_at_rest_mm", pair.rest_distance_mm},
                                    {"overlap_at_rest_mm", pair.rest_depth_mm},
                                    {"min_distance_mm", pair.least_distance_mm},
                                    {"min_distance_at", at(pair.least_frame)},
                                    {"beyond_rest_mm", pair.beyond_rest_mm},
                                    {"touching_frames", pair.touching_frames},
                                    {"violates_margin", pair.violates_margin},
                                    {"penetrates", pair.penetrates}};
    if (pair.first_touch >= 0) entry["first_contact"] = at(pair.first_touch);
    if (pair.beyond_rest_mm > 0) entry["deepest_at"] = at(pair.deepest_frame);
    json["pairs"].push_back(entry);
  }
  json["notes"] = scene.contacts.notes();
  return json.dump(2) + "\n";
}

std::string ClearanceCheck::text(double margin_mm) const {
  std::string text;
  for (const auto& pair : pairs) {
    const auto f =
        static_cast<std::size_t>(pair.penetrates ? pair.deepest_frame : pair.least_frame);
    text +=
        fmt::format("{} {} and {}: ", pair.penetrates || pair.violates_margin ? "VIOLATION" : "ok",
                    pair.a, pair.b);
    if (pair.rest_depth_mm > 0)
      text += fmt::format("overlap {:.2f} mm at rest; ", pair.rest_depth_mm);
    if (pair.penetrates && pair.beyond_rest_mm > 0)
      text += fmt::format("{:.2f} mm deeper than at rest at {:.1f} mm opening", pair.beyond_rest_mm,
                          opening_mm[f]);
    else if (pair.penetrates)
      text += fmt::format("they meet at {:.1f} mm opening",
                          opening_mm[static_cast<std::size_t>(pair.first_touch)]);
    else if (pair.touching_frames > 0)
      text += "touch, never deeper than at rest";
    else
      text += fmt::format("nearest {:.2f} mm at {:.1f} mm opening", pair.least_distance_mm,
                          opening_mm[f]);
    if (pair.violates_margin && !pair.penetrates)
      text += fmt::format(", less than the margin of {:.2f} mm", margin_mm);
    text += "\n";
  }
  return text;
}

}  // namespace condyle
