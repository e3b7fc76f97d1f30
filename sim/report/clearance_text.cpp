#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/report/clearance.h"

namespace condyle {

std::string ClearanceCheck::json(const Scene& scene, const Motion& motion, double margin_mm,
                                 const std::vector<std::string>& pictures,
                                 const std::vector<std::string>& notes) const {
  nlohmann::ordered_json json = {
      {"about", "Condyle; for research and education, not for clinical use"},
      {"case", scene.patient.name},
      {"motion", {{"name", motion.name}, {"duration_s", motion.duration_s}}},
      {"margin_mm", margin_mm},
      {"frames", frames},
      {"violation", violated()},
      {"max_opening_mm", *std::max_element(opening_mm.begin(), opening_mm.end())},
      {"pairs", nlohmann::ordered_json::array()}};
  const auto at = [&](int frame) {
    const auto f = static_cast<std::size_t>(frame);
    return nlohmann::ordered_json{{"frame", frame},
                                  {"opening_mm", opening_mm[f]},
                                  {"rotation_deg", rotation_deg[f]},
                                  {"time_s", time_s[f]}};
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& pair = pairs[i];
    nlohmann::ordered_json entry = {
        {"a", pair.a},
        {"b", pair.b},
        {"policy", pair.teeth ? "allowed contact" : "forbidden"},
        {"distance_at_rest_mm", pair.rest_distance_mm},
        {"overlap_at_rest_mm", pair.rest_depth_mm},
        {"min_distance_mm", pair.least_distance_mm},
        {"min_distance_at", at(pair.least_frame)},
        {"beyond_rest_mm", pair.beyond_rest_mm},
        {"touching_frames", pair.touching_frames},
        {"violates_margin", pair.violates_margin},
        {"penetrates", pair.penetrates},
        {"contact_frequency", static_cast<double>(pair.touching_frames) / frames},
        {"times_brought_together", pair.touches}};
    if (pair.first_touch >= 0) entry["first_contact"] = at(pair.first_touch);
    if (pair.beyond_rest_mm > 0) entry["deepest_at"] = at(pair.deepest_frame);
    auto worst = at(pair.worst_frame());
    const auto& detail = pair.detail;
    const auto list = [](const Eigen::Vector3d& p) {
      return nlohmann::ordered_json{p.x(), p.y(), p.z()};
    };
    worst["distance_mm"] = pair.worst.touching ? 0 : pair.worst.distance_mm;
    worst["depth_mm"] = pair.worst_depth_mm;
    worst["apart_there_at_rest"] = pair.worst_was_apart || pair.rest_depth_mm == 0;
    worst["contact_area_mm2"] = detail.area_mm2;
    worst["patches"] = detail.patches;
    if (detail.volume_known) {
      worst["penetration_volume_mm3"] = detail.volume_mm3;
      worst["penetration_volume_error_mm3"] = detail.volume_error_mm3;
    } else {
      worst["penetration_volume_mm3"] = nullptr;
    }
    worst["side"] = detail.side;
    worst["region"] = detail.region;
    worst["place_mm"] = list(detail.place);
    worst["normal"] = list(detail.normal);
    worst["open_surface_a"] = detail.open_a;
    worst["open_surface_b"] = detail.open_b;
    if (i < pictures.size() && !pictures[i].empty()) worst["picture"] = pictures[i];
    entry["worst"] = worst;
    json["pairs"].push_back(entry);
  }
  json["coronoid_zygoma"] = {{"available", !coronoids.empty()}};
  auto& coronoid = json["coronoid_zygoma"];
  for (const auto& side : coronoids) {
    coronoid[side.side] = {{"at_rest_mm", side.mm.front()},
                           {"min_mm", side.least_mm()},
                           {"min_at", at(side.least_frame)}};
    const auto widest = std::max_element(opening_mm.begin(), opening_mm.end()) - opening_mm.begin();
    coronoid[side.side]["at_widest_opening_mm"] = side.mm[static_cast<std::size_t>(widest)];
  }
  if (!coronoids_missing.empty()) coronoid["missing"] = coronoids_missing;
  json["methods"] = {
      {"contact_area",
       "surface of b inside a or within 0.1 mm of it; triangles at the rim divided "
       "to 0.25 mm and cut"},
      {"patches", "connected pieces of that surface; nearer than 0.5 mm counts as one"},
      {"penetration_volume",
       "columns along the shortest side of the common box, 256 across; the "
       "error is the largest difference to a grid twice as coarse"},
      {"coronoid_zygoma",
       "mandible within 8 mm of the coronoid tip, to cranial bone lateral of the "
       "tip and in front of half way to the condyle"}};
  json["notes"] = scene.contacts.notes();
  for (const auto& note : notes) json["notes"].push_back(note);
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
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
