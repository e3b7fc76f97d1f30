#include "tools/plan/graft_report.h"

#include <fmt/format.h>

#include "engine/mesh/topology.h"
#include "sim/operated/graft_path.h"
#include "sim/operation/graft_steps.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

Json donor_cut_json(const DonorCut& cut) {
  return {{"place_mm", cut.place_mm},
          {"angle_deg", cut.angle_deg},
          {"outward_deg", cut.outward_deg},
          {"up_deg", cut.up_deg}};
}

Json face_json(const GraftFaceReport& face) {
  using Level = GraftFaceReport::Level;
  const char* level = face.level == Level::good        ? "good"
                      : face.level == Level::wide      ? "wide"
                      : face.level == Level::very_wide ? "very_wide"
                                                       : "open";
  return {{"piece", face.piece},
          {"other", face.other},
          {"area_mm2", face.contact.area_mm2},
          {"contact_share", face.share},
          {"mean_gap_mm", face.contact.mean_gap_mm},
          {"largest_gap_mm", face.contact.largest_gap_mm},
          {"level", level}};
}

Json path_json(const InsertionPath& path) {
  Json json = {{"state", state_name(path.state)},
               {"direction", {path.direction.x(), path.direction.y(), path.direction.z()}},
               {"directions_examined", path.directions}};
  if (path.poses_examined > 0) {
    json["poses_examined"] = path.poses_examined;
    json["searched_mm"] = path.searched_mm;
  }
  if (path.turns()) {
    json["turn_deg"] = path.turn_deg;
    json["poses"] = Json::array();
    for (const Pose& X : path.poses)
      json["poses"].push_back({{"translation_mm", {X.t.x(), X.t.y(), X.t.z()}},
                               {"quaternion_wxyz", {X.R.w(), X.R.x(), X.R.y(), X.R.z()}}});
  }
  const Json at = {path.margin_at.x(), path.margin_at.y(), path.margin_at.z()};
  if (path.state == InsertionPath::State::blocked) {
    json["blocked_after_mm"] = path.blocked_after_mm;
    json["blocked_by"] = path.blocked_by;
    json["blocked_at_mm"] = at;
    return json;
  }
  json["length_mm"] = path.length_mm;
  json["margin_mm"] = path.margin_mm;
  if (path.margin_part.empty()) return json;
  json["margin_part"] = path.margin_part;
  json["margin_after_mm"] = path.margin_after_mm;
  json["margin_at_mm"] = at;
  return json;
}

/// The insertion path of each graft, in their order.
std::vector<InsertionPath> insertion_paths(const std::vector<Seat>& seats,
                                           const Operated& operated) {
  constexpr int threads = 2;  // the result is the same for any number
  std::vector<InsertionPath> paths;
  if (seats.empty()) return paths;
  const Case after = operated_case(operated);
  for (const Seat& seat : seats) paths.push_back(find_insertion_path(after, seat, threads));
  return paths;
}

Json graft_json(const Operated& operated, const GraftLayout& graft) {
  Json json = {
      {"name", graft.step.name},          {"donor", donor_label(graft.step)},
      {"replaces", graft.step.replaces},  {"donor_from_mm", graft.donor_from_mm},
      {"donor_to_mm", graft.donor_to_mm}, {"curve_deviation_mm", graft.curve_deviation_mm}};
  json["pieces"] = Json::array();
  for (const GraftPiece& piece : graft.pieces)
    json["pieces"].push_back(
        {{"name", piece.body},
         {"length_mm", piece.length_mm},
         {"start_mm", piece.start_mm},
         {"volume_mm3", piece.volume_mm3},
         {"closed", inspect(piece.mesh).closed()},
         {"saw_cuts", {donor_cut_json(piece.cuts[0]), donor_cut_json(piece.cuts[1])}}});
  json["spacing_mm"] = graft.spacing_mm;
  json["faces"] = Json::array();
  for (const GraftFaceReport& face : graft_faces(operated, graft))
    json["faces"].push_back(face_json(face));
  json["overlaps"] = graft_overlaps(operated, graft);
  json["warnings"] = graft.warnings;
  return json;
}

std::string graft_text(const Operated& operated, const GraftLayout& graft,
                       const std::string& path) {
  std::string text = fmt::format("graft {}\n", graft.step.name);
  for (const std::string& sentence : graft_sentences(operated, graft))
    text += "  " + sentence + "\n";
  return text + "  " + path + "\n";
}

}  // namespace

void add_graft_report(Json& report, const Plan& plan, const Operated& operated) {
  report["resections"] = Json::array();
  for (const Resection& resection : operated.resections)
    report["resections"].push_back({{"step", resection.step},
                                    {"segment", resection.segment},
                                    {"volume_mm3", resection.volume_mm3},
                                    {"teeth", resection.teeth}});
  report["grafts"] = Json::array();
  const auto paths = insertion_paths(graft_seats(operated, plan), operated);
  for (std::size_t i = 0; i < operated.grafts.size(); ++i) {
    report["grafts"].push_back(graft_json(operated, operated.grafts[i]));
    report["grafts"].back()["insertion_path"] = path_json(paths[i]);
  }
}

std::string graft_report_text(const Plan& plan, const Operated& operated) {
  std::string text;
  for (const Resection& resection : operated.resections)
    text += resection_sentence(resection) + "\n";
  for (const GraftLayout& graft : operated.grafts)
    text += graft_report_text(plan, operated, graft.step.name);
  return text;
}

std::string graft_report_text(const Plan& plan, const Operated& operated, const std::string& name) {
  const auto seats = graft_seats(operated, plan);
  for (std::size_t i = 0; i < seats.size(); ++i)
    if (seats[i].name == name) {
      const std::vector<InsertionPath> path = insertion_paths({seats[i]}, operated);
      return graft_text(operated, operated.grafts[i], insertion_path_text(path.front(), seats[i]));
    }
  return "";
}

}  // namespace condyle
