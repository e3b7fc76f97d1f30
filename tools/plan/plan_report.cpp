#include "tools/plan/plan_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/core/error.h"
#include "sim/operation/cut_text.h"
#include "sim/operation/segment_overlaps.h"
#include "sim/operation/trim_segments.h"
#include "sim/plan/cephalometry.h"
#include "tools/plan/graft_report.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

/// Tables need the patient's own directions; a case without the landmarks has none.
std::optional<ClinicalFrame> frame_of(const Plan& plan, const Operated& operated,
                                      std::string& problem) {
  try {
    return clinical_frame(operated.patient.landmarks, plan.reference);
  } catch (const InputError& error) {
    problem = error.what();
    return std::nullopt;
  }
}

std::vector<CephalometricMeasure> measures_of(const ClinicalFrame& frame,
                                              const Operated& operated) {
  return cephalometry(frame, operated.patient.landmarks, planned_landmarks(operated));
}

Json outcome_json(const std::string& name, const CutOutcome& outcome) {
  Json json = {{"name", name},
               {"meets_bone", outcome.meets_bone},
               {"through", outcome.through},
               {"open_on_purpose", outcome.open_on_purpose},
               {"cut_face_area_mm2", outcome.wall_area_mm2}};
  if (outcome.meets_bone && !outcome.through) {
    json["bone_left_mm"] = outcome.left_mm;
    json["bone_left_at_mm"] = {outcome.left_at.x(), outcome.left_at.y(), outcome.left_at.z()};
  }
  for (const CutWindow& window : outcome.windows)
    json["windows"].push_back(
        {{"area_mm2", window.area_mm2}, {"at_mm", {window.at.x(), window.at.y(), window.at.z()}}});
  return json;
}

Json danger_json(const DangerFinding& finding) {
  const char* level = finding.level == DangerLevel::stop   ? "stop"
                      : finding.level == DangerLevel::warn ? "warn"
                                                           : "clear";
  return {{"zone", finding.zone},
          {"distance_mm", finding.distance_mm},
          {"warn_mm", finding.margin.warn_mm},
          {"stop_mm", finding.margin.stop_mm},
          {"interdental", finding.interdental},
          {"at_mm", {finding.at.x(), finding.at.y(), finding.at.z()}},
          {"level", level}};
}

Json cut_json(const CutReport& cut) {
  Json json = {{"step", cut.step}, {"title", cut.title}, {"bone", cut.bone}};
  json["outcomes"] = Json::array();
  for (std::size_t i = 0; i < cut.outcomes.size(); ++i)
    json["outcomes"].push_back(outcome_json(cut.cuts[i], cut.outcomes[i]));
  json["crossings"] = Json::array();
  for (const auto& [a, b] : cut.crossings) json["crossings"].push_back({cut.cuts[a], cut.cuts[b]});
  json["danger_zones"] = Json::array();
  for (const DangerFinding& finding : cut.dangers)
    json["danger_zones"].push_back(danger_json(finding));
  json["below_margins"] = cut.below_margins;
  json["pieces"] = Json::array();
  for (const CutPiece& piece : cut.pieces)
    json["pieces"].push_back({{"body", piece.body},
                              {"part", piece.part},
                              {"stays", piece.stays},
                              {"volume_mm3", piece.volume_mm3},
                              {"separate_pieces", piece.pieces},
                              {"slivers", piece.slivers}});
  json["kerf_volume_mm3"] = cut.kerf_volume_mm3;
  json["volume_error_percent"] = cut.volume_error_percent();
  if (!cut.rooms.empty()) json["interdental_room"] = cut.rooms;
  json["notes"] = cut.notes;
  return json;
}

Json trim_json(const TrimReport& trim) {
  Json json = {{"step", trim.step}, {"title", trim.title}, {"segment", trim.segment}};
  json["removed"] = Json::array();
  for (const auto& share : trim.shares)
    json["removed"].push_back({{"beyond_faces_of", share.of}, {"volume_mm3", share.volume_mm3}});
  json["fragments"] = trim.fragments;
  json["fragments_volume_mm3"] = trim.fragments_mm3;
  json["removed_volume_mm3"] = trim.removed_mm3();
  json["volume_before_mm3"] = trim.before_mm3;
  json["volume_after_mm3"] = trim.after_mm3;
  json["separate_pieces"] = trim.pieces;
  json["danger_zones"] = Json::array();
  for (const DangerFinding& finding : trim.dangers)
    json["danger_zones"].push_back(danger_json(finding));
  json["below_margins"] = trim.below_margins;
  json["volume_error_percent"] = trim.volume_error_percent();
  json["notes"] = trim.notes;
  return json;
}

Json overlap_json(const SegmentOverlap& overlap) {
  const char* kind = overlap.kind == SegmentOverlap::Kind::trimmed    ? "trimmed"
                     : overlap.kind == SegmentOverlap::Kind::occlusal ? "occlusal"
                                                                      : "collision";
  return {{"a", overlap.a},
          {"b", overlap.b},
          {"kind", kind},
          {"depth_mm", overlap.depth_mm},
          {"volume_mm3", overlap.volume_mm3},
          {"at_mm", {overlap.at.x(), overlap.at.y(), overlap.at.z()}}};
}

std::string overlaps_text(const Operated& operated) {
  std::string text;
  for (const SegmentOverlap& overlap : segment_overlaps(operated))
    text += overlap_text(overlap, present_landmarks(operated)) + "\n";
  return text.empty() ? text : "\nOverlap at the planned positions\n" + text;
}

std::string cut_text(const CutReport& cut, const Landmarks& landmarks) {
  std::string text = fmt::format("step {} ({}), {}\n", cut.step, cut.title, cut.bone);
  for (const std::string& sentence : cut_sentences(cut, landmarks)) text += "  " + sentence + "\n";
  return text;
}

std::string trim_text(const TrimReport& trim) {
  std::string text = fmt::format("step {} ({}), {}\n", trim.step, trim.title, trim.part);
  for (const std::string& sentence : trim_sentences(trim)) text += "  " + sentence + "\n";
  return text;
}

}  // namespace

Json plan_report_json(const Plan& plan, const Operated& operated) {
  Json json = {{"plan", plan.name}, {"case", operated.patient.name}};
  json["segments"] = Json::array();
  json["remaining"] = Json::array();
  for (const BoneSummary& bone : operated_bones(operated)) {
    Json item = {{"name", bone.name}};
    if (bone.is_segment) item["parent"] = bone.parent;
    item["volume_mm3"] = bone.volume_mm3;
    item["closed"] = bone.closed;
    if (bone.trimmed_mm3 > 0) item["trimmed_mm3"] = bone.trimmed_mm3;
    json[bone.is_segment ? "segments" : "remaining"].push_back(std::move(item));
  }
  double error = 0;
  json["cuts"] = Json::array();
  for (const CutReport& cut : operated.cuts) {
    json["cuts"].push_back(cut_json(cut));
    error = std::max(error, cut.volume_error_percent());
  }
  json["trims"] = Json::array();
  for (const TrimReport& trim : operated.trims) {
    json["trims"].push_back(trim_json(trim));
    error = std::max(error, trim.volume_error_percent());
  }
  json["volume_error_percent"] = error;
  add_graft_report(json, plan, operated);
  json["overlaps"] = Json::array();
  for (const SegmentOverlap& overlap : segment_overlaps(operated))
    json["overlaps"].push_back(overlap_json(overlap));
  std::string problem;
  if (const auto frame = frame_of(plan, operated, problem)) {
    json["movements"] = movement_json(planned_movements(operated, *frame));
    json["cephalometry"] = cephalometry_json(measures_of(*frame, operated));
  }
  json["notes"] = operated.notes;
  if (!problem.empty()) json["notes"].push_back("no tables: " + problem);
  json["problems"] = operated.problems;
  return json;
}

std::string plan_report_text(const Plan& plan, const Operated& operated) {
  std::string text = fmt::format("{}, a plan for {}\n{}{}", plan.name, operated.patient.name,
                                 steps_text(plan), zones_text(plan));
  for (const CutReport& cut : operated.cuts)
    text += "\n" + cut_text(cut, operated.patient.landmarks);
  for (const TrimReport& trim : operated.trims) text += "\n" + trim_text(trim);
  if (const std::string grafts = graft_report_text(plan, operated); !grafts.empty())
    text += "\n" + grafts;
  text += overlaps_text(operated);
  std::string problem;
  if (const auto frame = frame_of(plan, operated, problem))
    text +=
        "\n" + movement_text(planned_movements(operated, *frame)) +
        "\nCephalometry (of the face: before the operation; condyle predict has it afterwards)\n" +
        cephalometry_text(measures_of(*frame, operated));
  else
    text += "\nno tables: " + problem + "\n";
  return text;
}

std::string cut_report_text(const Operated& operated, int step) {
  std::string text;
  for (const CutReport& cut : operated.cuts)
    if (cut.step == step) text += cut_text(cut, operated.patient.landmarks);
  for (const TrimReport& trim : operated.trims)
    if (trim.step == step) text += trim_text(trim);
  return text;
}

}  // namespace condyle
