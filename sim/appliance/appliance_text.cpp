#include "sim/appliance/appliance_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

Json point_json(const Eigen::Vector3d& p) { return Json::array({p.x(), p.y(), p.z()}); }

Json print_json(const PrintMeasure& print) {
  return {{"on", print.on},
          {"insertion_direction", point_json(print.seat)},
          {"tilt_deg", print.tilt_deg ? Json(*print.tilt_deg) : Json()},
          {"fit_mean_mm", print.fit_mean_mm},
          {"fit_p95_mm", print.fit_p95_mm},
          {"fit_max_mm", print.fit_max_mm},
          {"overlap_mm", print.overlap_mm},
          {"undercut_mm", print.undercut_mm},
          {"print_area_mm2", print.area_mm2},
          {"relieved_area_mm2", print.relieved_mm2},
          {"rim_area_mm2", print.rim_mm2},
          {"not_reached_area_mm2", print.not_reached_mm2}};
}

Json gaps_json(const std::vector<SlotGap>& gaps) {
  Json json = Json::array();
  for (const SlotGap& gap : gaps)
    json.push_back({{"from", point_json(gap.from)},
                    {"to", point_json(gap.to)},
                    {"length_mm", gap.length_mm},
                    {"walls", gap.both ? 0 : 1}});
  return json;
}

std::string other_bones_text(const Guide& guide) {
  std::string text;
  for (const CrossedBone& bone : guide.bones)
    if (bone.name != guide.on)
      text += fmt::format("{}{} ({:.0f} mm)", text.empty() ? "" : ", ", bone.name, bone.length_mm);
  return text.empty() ? text
                      : "; the cut also passes through " + text + ", which --on makes a guide for";
}

/// Where walls are missing, longest first.
std::string gaps_text(const Guide& guide) {
  constexpr std::size_t most_named = 4;
  std::vector<SlotGap> gaps;
  for (const GuideSlot& slot : guide.slots)
    gaps.insert(gaps.end(), slot.gaps.begin(), slot.gaps.end());
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const SlotGap& a, const SlotGap& b) { return a.length_mm > b.length_mm; });
  std::string text;
  for (std::size_t i = 0; i < std::min(gaps.size(), most_named); ++i) {
    const Eigen::Vector3d middle = 0.5 * (gaps[i].from + gaps[i].to);
    text += fmt::format("{}{} for {:.1f} mm at ({:.0f}, {:.0f}, {:.0f})", i == 0 ? "" : ", ",
                        gaps[i].both ? "both walls" : "one wall", gaps[i].length_mm, middle.x(),
                        middle.y(), middle.z());
  }
  if (gaps.size() > most_named) text += fmt::format(", {} more", gaps.size() - most_named);
  return text.empty() ? text : "; missing: " + text;
}

}  // namespace

std::string direction_text(const Eigen::Vector3d& direction) {
  const char* words[3][2] = {{"right", "left"}, {"front", "back"}, {"down", "up"}};
  std::string text;
  for (const int axis : {2, 1, 0})
    if (std::abs(direction[axis]) >= 0.005)
      text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", words[axis][direction[axis] > 0],
                          std::abs(direction[axis]));
  return text;
}

std::string measure_text(const ApplianceMeasure& measure, double grip_mm) {
  std::string text = fmt::format(
      "surface: {}, {} piece{}, {} triangles, {:.1f} cm³, {:.0f} x {:.0f} x {:.0f} mm\n"
      "smallest wall: {:.2f} mm; 95 % of walls are at least {:.2f} mm\n",
      measure.closed ? "closed" : "NOT closed", measure.pieces, measure.pieces == 1 ? "" : "s",
      measure.triangles, measure.volume_mm3 / 1000, measure.size_mm[0], measure.size_mm[1],
      measure.size_mm[2], measure.wall_min_mm, measure.wall_p5_mm);
  for (const PrintMeasure& print : measure.prints)
    text += fmt::format(
        "{}: seated {}{}; fit {:.2f} mm at most, 95 % within {:.2f} mm, over {:.0f} mm² (rims "
        "{:.0f}, "
        "relieved {:.0f}, not reached {:.0f} mm²); overlap {:.2f} mm; undercut {:.2f} mm, grip "
        "{:.2f} mm\n",
        print.on, direction_text(print.seat),
        print.tilt_deg ? fmt::format(" ({:.0f} degrees from the normal)", *print.tilt_deg) : "",
        print.fit_max_mm, print.fit_p95_mm, print.area_mm2, print.rim_mm2, print.relieved_mm2,
        print.not_reached_mm2, print.overlap_mm, print.undercut_mm, grip_mm);
  return text;
}

Json measure_json(const ApplianceMeasure& measure) {
  Json prints = Json::array();
  for (const PrintMeasure& print : measure.prints) prints.push_back(print_json(print));
  return {{"closed", measure.closed},
          {"pieces", measure.pieces},
          {"triangles", measure.triangles},
          {"volume_mm3", measure.volume_mm3},
          {"size_mm", Json::array({measure.size_mm[0], measure.size_mm[1], measure.size_mm[2]})},
          {"smallest_wall_mm", measure.wall_min_mm},
          {"smallest_wall_at", point_json(measure.wall_at)},
          {"wall_p5_mm", measure.wall_p5_mm},
          {"prints", prints}};
}

std::string splint_text(const Splint& splint, const SplintSettings& settings) {
  std::string text = fmt::format(
      "bite: {}; the arches were {:.2f} mm apart at least and are {:.2f}\n"
      "thickness between cusps: {:.2f} mm (at least {:.2f})\n",
      splint.opening_deg == 0
          ? std::string("as planned")
          : fmt::format("opened by the hinge, {:.2f} mm at the incisors ({:.2f} degrees)",
                        splint.opening_mm, splint.opening_deg),
      splint.clearance_before_mm, splint.clearance_mm, splint.thickness_mm, settings.thickness_mm);
  return text + measure_text(splint.measure, settings.grip_mm);
}

Json splint_json(const Splint& splint, const SplintSettings& settings) {
  const Eigen::Quaterniond& q = splint.X_lower.R;
  Json json{{"opening_mm", splint.opening_mm},
            {"opening_deg", splint.opening_deg},
            {"clearance_before_mm", splint.clearance_before_mm},
            {"clearance_mm", splint.clearance_mm},
            {"lower_arch_rotation_wxyz", Json::array({q.w(), q.x(), q.y(), q.z()})},
            {"lower_arch_translation_mm", point_json(splint.X_lower.t)},
            {"thickness_mm", splint.thickness_mm}};
  json.update(measure_json(splint.measure));
  json["settings"] = lengths_json<Json>(settings, splint_lengths);
  json["notes"] = splint.notes;
  return json;
}

std::string guide_text(const Guide& guide, const GuideSettings& settings) {
  double least = 1e9, most = 0, wall = 1e9;
  for (const GuideSlot& slot : guide.slots) {
    if (slot.width_max_mm == 0) continue;
    least = std::min(least, slot.width_min_mm);
    most = std::max(most, slot.width_max_mm);
    wall = std::min(wall, slot.wall_min_mm);
  }
  std::string text = fmt::format(
      "bone: {}{}\n"
      "saw: {}, blade {:.2f} mm ({}); bone {:.1f} mm thick in its direction\n"
      "slot: {} piece{}, {:.0f} of {:.0f} mm of the cut on this side; width {:.2f} to {:.2f} mm "
      "(intended {:.2f}); walls {:.2f} mm at least\n"
      "guided between two walls: {:.0f} mm{}\n",
      guide.on, other_bones_text(guide), settings.saw.name, settings.saw.blade_mm,
      settings.saw.source, guide.bone_mm, guide.slots.size(), guide.slots.size() == 1 ? "" : "s",
      guide.led_mm, guide.line_mm, least, most, guide.slot_mm, wall, guide.guided_mm,
      gaps_text(guide));
  if (!guide.holes.empty()) {
    text += fmt::format("screw holes: {}, diameter", guide.holes.size());
    for (const ScrewHole& hole : guide.holes) text += fmt::format(" {:.2f}", hole.diameter_mm);
    text += " mm\n";
  }
  return text + measure_text(guide.measure, settings.grip_mm);
}

Json guide_json(const Guide& guide, const GuideSettings& settings) {
  Json slots = Json::array(), holes = Json::array(), bones = Json::array();
  for (const CrossedBone& bone : guide.bones)
    bones.push_back({{"name", bone.name}, {"cut_length_mm", bone.length_mm}});
  for (const GuideSlot& slot : guide.slots)
    slots.push_back({{"from", point_json(slot.from)},
                     {"to", point_json(slot.to)},
                     {"length_mm", slot.length_mm},
                     {"guided_mm", slot.guided_mm},
                     {"missing_walls", gaps_json(slot.gaps)},
                     {"width_min_mm", slot.width_min_mm},
                     {"width_max_mm", slot.width_max_mm},
                     {"wall_min_mm", slot.wall_min_mm}});
  for (const ScrewHole& hole : guide.holes)
    holes.push_back({{"point", point_json(hole.point)},
                     {"axis", point_json(hole.axis)},
                     {"diameter_mm", hole.diameter_mm}});
  Json json{{"on", guide.on},
            {"bones", bones},
            {"saw", settings.saw.name},
            {"blade_mm", settings.saw.blade_mm},
            {"slot_mm", guide.slot_mm},
            {"bone_mm", guide.bone_mm},
            {"cut_length_mm", guide.line_mm},
            {"slot_length_mm", guide.led_mm},
            {"guided_length_mm", guide.guided_mm},
            {"slots", slots},
            {"holes", holes}};
  json.update(measure_json(guide.measure));
  json["settings"] = lengths_json<Json>(settings, guide_lengths);
  json["notes"] = guide.notes;
  return json;
}

}  // namespace condyle
