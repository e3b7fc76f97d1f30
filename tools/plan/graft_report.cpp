#include "tools/plan/graft_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/mesh/topology.h"
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

Json graft_json(const Operated& operated, const GraftLayout& graft) {
  Json json = {
      {"name", graft.step.name},          {"donor", graft.donor_name},
      {"replaces", graft.step.replaces},  {"donor_from_mm", graft.donor_from_mm},
      {"donor_to_mm", graft.donor_to_mm}, {"curve_deviation_mm", graft.curve_deviation_mm}};
  json["pieces"] = Json::array();
  for (const GraftPiece& piece : graft.pieces)
    json["pieces"].push_back(
        {{"name", piece.body},
         {"length_mm", piece.length_mm},
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

std::string graft_text(const Operated& operated, const GraftLayout& graft) {
  std::string text = fmt::format("graft {}\n", graft.step.name);
  for (const std::string& sentence : graft_sentences(operated, graft))
    text += "  " + sentence + "\n";
  return text;
}

}  // namespace

void add_graft_report(Json& report, const Operated& operated) {
  report["resections"] = Json::array();
  for (const Resection& resection : operated.resections)
    report["resections"].push_back({{"step", resection.step},
                                    {"segment", resection.segment},
                                    {"volume_mm3", resection.volume_mm3},
                                    {"teeth", resection.teeth}});
  report["grafts"] = Json::array();
  for (const GraftLayout& graft : operated.grafts)
    report["grafts"].push_back(graft_json(operated, graft));
}

std::string graft_report_text(const Operated& operated) {
  std::string text;
  for (const Resection& resection : operated.resections)
    text +=
        fmt::format("resected: {}, {:.1f} cm³{}\n", resection.segment, resection.volume_mm3 / 1000,
                    resection.teeth.empty()
                        ? ""
                        : fmt::format(", with the teeth {}", fmt::join(resection.teeth, ", ")));
  for (const GraftLayout& graft : operated.grafts) text += graft_text(operated, graft);
  return text;
}

std::string graft_report_text(const Operated& operated, const std::string& name) {
  for (const GraftLayout& graft : operated.grafts)
    if (graft.step.name == name) return graft_text(operated, graft);
  return "";
}

}  // namespace condyle
