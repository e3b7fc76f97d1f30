#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/report/check_page.h"
#include "sim/report/clearance.h"
#include "sim/report/point_json.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const MotionTime& when) {
  return {{"frame", when.frame},
          {"between_frames", when.between},
          {"opening_mm", when.opening_mm},
          {"rotation_deg", when.rotation_deg},
          {"time_s", when.time_s}};
}

Json worst_of(const PairVerdict& pair) {
  const auto& [when, sample, measure, poses] = pair.worst;
  Json worst = json_of(when);
  worst["distance_mm"] = sample.contact.touching ? 0 : sample.contact.distance_mm;
  worst["signed_distance_mm"] = sample.signed_distance_mm();
  worst["depth_mm"] = sample.depth_mm;
  worst["apart_there_at_rest"] = sample.was_apart || pair.rest_depth_mm == 0;
  worst["witness_a_mm"] = list(sample.contact.witness_a);
  worst["witness_b_mm"] = list(sample.contact.witness_b);
  worst["contact_area_mm2"] = measure.area_mm2;
  worst["patches"] = measure.patches;
  const bool known = measure.volume_known || !sample.contact.touching;
  worst["penetration_volume_mm3"] = known ? Json(measure.volume_mm3) : Json(nullptr);
  worst["penetration_volume_error_mm3"] = known ? Json(measure.volume_error_mm3) : Json(nullptr);
  worst["side"] = measure.side;
  worst["region"] = measure.region();
  worst["region_a"] = measure.region_a;
  worst["region_b"] = measure.region_b;
  worst["place_mm"] = list(measure.place);
  worst["normal"] = list(measure.normal);
  worst["open_surface_a"] = measure.open_a;
  worst["open_surface_b"] = measure.open_b;
  return worst;
}

Json methods() {
  return {
      {"depth",
       "penetration at the deepest point; beyond_rest: in excess of the depth at rest, where the "
       "bones overlap at rest at that point"},
      {"between_frames",
       "where clearance and motion cannot exclude that bones touch, or come 0.1 mm closer or "
       "deeper than in any frame, additional samples are taken between frames, down to 0.1 mm of "
       "motion"},
      {"contact_area",
       "surface of b inside a or within 0.1 mm of it; triangles at the rim are subdivided "
       "to 0.25 mm (coarser where more than 1250 mm2 are close) and clipped"},
      {"patches", "connected components of that surface; those closer than 0.5 mm count as one"},
      {"penetration_volume",
       "columns along the shortest side of the common bounding box, 128 across; the error is "
       "the largest difference from a grid of twice the spacing; null for open surfaces"},
      {"coronoid_zygoma",
       "from the mandible within 8 mm of the coronoid tip to cranial bone lateral of the tip and "
       "in front of the midpoint between tip and condyle"}};
}

}  // namespace

std::string ClearanceCheck::json(const Scene& scene, const Motion& motion,
                                 const std::vector<std::string>& pictures,
                                 const std::vector<std::string>& notes) const {
  Json json = {{"about", "Condyle; for research and education, not for clinical use"},
               {"case", scene.patient.name},
               {"motion", {{"name", motion.name}, {"duration_s", motion.duration_s}}},
               {"margin_mm", margin_mm},
               {"frames", frames()},
               {"samples_between_frames", samples_between},
               {"violation", violated()},
               {"max_opening_mm", opening_mm[widest_frame()]},
               {"pairs", Json::array()}};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& pair = pairs[i];
    Json entry = {{"a", pair.a},
                  {"b", pair.b},
                  {"policy", policy_name(pair.rule.policy)},
                  {"margin_mm", pair.rule.policy == PairPolicy::forbidden ? pair.required_mm : 0.0},
                  {"violation", pair.violated()},
                  {"verdict", verdict_text(pair)},
                  {"penetrates", pair.collides},
                  {"violates_margin", pair.too_close},
                  {"violation_at_rest", pair.at_rest},
                  {"distance_at_rest_mm", pair.rest_distance_mm},
                  {"overlap_at_rest_mm", pair.rest_depth_mm},
                  {"min_distance_mm", pair.min_distance_mm},
                  {"min_distance_at", json_of(pair.min_distance_at)},
                  {"beyond_rest_mm", pair.beyond_rest_mm},
                  {"touching_frames", pair.touching_frames},
                  {"contact_frequency", static_cast<double>(pair.touching_frames) / frames()},
                  {"times_brought_together", pair.touches}};
    if (pair.rule.policy == PairPolicy::guided || pair.rule.policy == PairPolicy::cut_face)
      entry["gap"] = {{"required_mm", pair.required_mm},
                      {"min_mm", pair.min_distance_mm},
                      {"min_at", json_of(pair.min_distance_at)},
                      {"max_mm", pair.max_distance_mm},
                      {"max_at", json_of(pair.max_distance_at)}};
    if (pair.first_touch) entry["first_contact"] = json_of(*pair.first_touch);
    if (pair.beyond_rest_mm > 0) entry["deepest_at"] = json_of(pair.deepest_at);
    if (pair.push_out_mm) entry["push_out"] = list(*pair.push_out_mm);
    entry["worst"] = worst_of(pair);
    if (i < pictures.size() && !pictures[i].empty()) entry["worst"]["picture"] = pictures[i];
    json["pairs"].push_back(entry);
  }
  json["teeth"] = Json::array();
  for (const auto& tooth : teeth)
    json["teeth"].push_back(
        {{"fdi", tooth.fdi},
         {"touching_frames", tooth.touching_frames},
         {"contact_frequency", static_cast<double>(tooth.touching_frames) / frames()},
         {"times_brought_together", tooth.touches}});
  json["coronoid_zygoma"] = {{"available", !coronoids.empty()}};
  auto& coronoid = json["coronoid_zygoma"];
  for (const auto& side : coronoids) {
    const auto f = static_cast<std::size_t>(side.min_frame());
    coronoid[side.side] = {
        {"at_rest_mm", side.mm.front()},
        {"min_mm", side.min_mm()},
        {"min_at", json_of({side.min_frame(), false, time_s[f], opening_mm[f], rotation_deg[f]})},
        {"at_widest_opening_mm", side.mm[widest_frame()]},
        {"tip_mm", list(side.tip)},
        {"tip_estimated", side.estimated}};
  }
  if (!coronoids_missing.empty()) coronoid["missing"] = coronoids_missing;
  json["methods"] = methods();
  json["notes"] = scene.contacts.notes();
  for (const auto& note : notes) json["notes"].push_back(note);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ClearanceCheck::text() const {
  std::string text = summary_text(*this) + "\n";
  for (const std::size_t i : worst_first(*this)) {
    const auto& pair = pairs[i];
    text += fmt::format("{} {} and {}: {}\n", pair.violated() ? "VIOLATION" : "ok", pair.a, pair.b,
                        verdict_text(pair));
  }
  return text;
}

}  // namespace condyle
