#include "sim/report/occlusion_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/collide/signed_surface.h"
#include "engine/mesh/refine.h"
#include "sim/report/point_json.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Pose& pose) {
  return {{"t_mm", list(pose.t)}, {"q_wxyz", {pose.R.w(), pose.R.x(), pose.R.y(), pose.R.z()}}};
}

Json json_of(const IncisorOverlap& overlap) {
  return {{"overjet_mm", overlap.overjet_mm}, {"overbite_mm", overlap.overbite_mm}};
}

Json tooth(int fdi) { return fdi ? Json(fdi) : Json(nullptr); }

std::string csv_row(double time_s, const Pose& pose) {
  return fmt::format("{},{},{},{},{},{},{},{}\n", time_s, pose.t.x(), pose.t.y(), pose.t.z(),
                     pose.R.w(), pose.R.x(), pose.R.y(), pose.R.z());
}

constexpr const char* csv_header = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n";

}  // namespace

std::string displacement_text(const Eigen::Vector3d& displacement_mm) {
  const char* const names[3][2] = {{"left", "right"}, {"back", "forward"}, {"up", "down"}};
  constexpr double min_mm = 0.05;
  std::string text;
  for (const int axis : {2, 1, 0})
    if (std::abs(displacement_mm[axis]) >= min_mm)
      text += fmt::format("{}{:.1f} mm {}", text.empty() ? "" : ", ",
                          std::abs(displacement_mm[axis]), names[axis][displacement_mm[axis] < 0]);
  return text.empty() ? "no displacement" : text;
}

std::string bite_pose_csv(const Bite& bite) { return csv_header + csv_row(0, bite.rest.X_CM); }

std::string bite_motion_csv(const Bite& bite, const Pose& start) {
  constexpr double open_mm = 5;
  const auto lowered = [&](Pose pose) {
    pose.t -= open_mm * bite.up;
    return pose;
  };
  return csv_header + csv_row(0, start) + csv_row(0.7, lowered(start)) +
         csv_row(1.3, lowered(bite.rest.X_CM)) + csv_row(2, bite.rest.X_CM);
}

std::string OcclusionReport::json() const {
  Json json = {{"about", "Condyle; for research and education, not for clinical use"},
               {"case", patient},
               {"start", start},
               {"paper_mm", settings.film_mm},
               {"closing_force_N", settings.closing_force_N},
               {"joint_N_per_mm", settings.joint_N_per_mm},
               {"stable", bite.stable}};
  if (!bite.stable) json["unstable_because"] = bite.unstable_because;
  json["X_CM"] = json_of(bite.rest.X_CM);
  json["upper_arch"] = bite.upper;
  json["lower_arch"] = bite.lower;
  json["gap_mm"] = bite.gap_mm;
  json["overlap_mm"] = bite.overlap_mm;
  json["moved_from_start_mm"] = bite.moved_from_start_mm;
  json["moved_from_rest_mm"] = bite.moved_from_rest_mm;
  json["rotation_from_rest_deg"] = bite.rotation_deg;
  json["incisors"] = {{"at_rest", json_of(bite.before)}, {"in_bite", json_of(bite.after)}};
  if (bite.condyle_moved)
    json["condyles_moved_mm"] = {{"left", list((*bite.condyle_moved)[0])},
                                 {"right", list((*bite.condyle_moved)[1])}};
  json["load"] = {
      {"left_share", bite.left_fraction},
      {"right_share", bite.contacts.empty() ? 0 : 1 - bite.left_fraction},
      {"front_teeth_share", bite.front_known ? Json(bite.front_fraction) : Json(nullptr)},
      {"center_mm", list(bite.load_center)},
      {"joints_over_closing_force", bite.joint_fraction}};
  json["contacts"] = Json::array();
  for (const auto& contact : bite.contacts)
    json["contacts"].push_back({{"upper", tooth(contact.upper_fdi)},
                                {"lower", tooth(contact.lower_fdi)},
                                {"side", contact.left ? "left" : "right"},
                                {"place_mm", list(contact.place)},
                                {"normal", list(contact.normal)},
                                {"area_mm2", contact.area_mm2},
                                {"gap_mm", contact.gap_mm},
                                {"load_share", contact.load_fraction}});
  json["teeth"] = Json::array();
  for (const auto& load : bite.teeth)
    json["teeth"].push_back({{"fdi", load.fdi},
                             {"contacts", load.contacts},
                             {"area_mm2", load.area_mm2},
                             {"load_share", load.load_fraction}});
  json["closings_tried"] = bite.starts;
  json["rest_work_Nmm"] = bite.rest.work;
  json["residual_N"] = bite.rest.residual_N;
  json["other_bites"] = Json::array();
  for (const auto& other : bite.others)
    json["other_bites"].push_back({{"X_CM", json_of(other.X_CM)}, {"rest_work_Nmm", other.work}});
  json["methods"] = {
      {"bite",
       "the arches close on an elastic film of the thickness of the articulating paper; the "
       "closing "
       "force acts upward, perpendicular to the occlusal plane of the upper teeth, half of it at "
       "each lower first molar; springs hold the centres of the condyles at their rest positions; "
       "of all equilibria, the one of lowest energy"},
      {"contacts",
       "surface of the lower arch closer to the upper arch than the thickness of the film"},
      {"load", "force transmitted by the film; fractions of the sum over all contacts"},
      {"gap_overlap", "exact: least distance between triangles; deepest vertex inside"},
      {"overjet_overbite",
       "from the upper to the lower incisal edges, parallel and perpendicular to the plane through "
       "the upper incisal edge and first molars"}};
  if (!picture.empty()) json["picture"] = picture;
  json["notes"] = bite.notes;
  for (const auto& note : notes) json["notes"].push_back(note);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string OcclusionReport::text() const {
  std::string text =
      bite.stable ? "stable bite" : "NO stable bite: " + bite.unstable_because + "; pose reached";
  text += fmt::format(": {} contacts at {:g} mm paper, load {:.0f} % left and {:.0f} % right\n",
                      bite.contacts.size(), settings.film_mm, 100 * bite.left_fraction,
                      bite.contacts.empty() ? 0.0 : 100 * (1 - bite.left_fraction));
  if (bite.overlap_mm > 0)
    text += fmt::format("arches overlap by {:.3f} mm; ", bite.overlap_mm);
  else
    text += fmt::format("least gap of the arches {:.3f} mm; ", bite.gap_mm);
  text += fmt::format("overjet {:.1f} mm, overbite {:.1f} mm\n", bite.after.overjet_mm,
                      bite.after.overbite_mm);
  text += fmt::format("displacement {:.2f} mm from the start, {:.2f} mm from rest",
                      bite.moved_from_start_mm, bite.moved_from_rest_mm);
  if (bite.condyle_moved)
    text += fmt::format("; condyles from rest: left {}, right {}",
                        displacement_text((*bite.condyle_moved)[0]),
                        displacement_text((*bite.condyle_moved)[1]));
  return text + "\n";
}

BiteView bite_view(const Case& patient, const Bite& bite, int threads) {
  constexpr double fine_mm = 0.12, about_mm = 2, reach_mm = 3;
  BiteView view;
  const Part *upper = nullptr, *lower = nullptr;
  for (const auto& part : patient.parts) {
    if (!collides(part.role) || part.mesh.empty()) continue;
    view.parts.push_back(part);
    if (part.name == bite.upper) upper = &part;
    if (part.name == bite.lower) lower = &part;
  }
  const Pose X_MC = bite.rest.X_CM.inverse();
  const auto gaps = [&](const Part& part, const Pose& X_part, const Part& other,
                        const Pose& X_other, const Pose& X_to_part) {
    Part& drawn = *std::find_if(view.parts.begin(), view.parts.end(),
                                [&](const Part& p) { return p.name == part.name; });
    for (const auto& contact : bite.contacts)
      drawn.mesh = refine_near(std::move(drawn.mesh), X_to_part * contact.place, about_mm, fine_mm);
    std::vector<Eigen::Vector3d> points;
    points.reserve(drawn.mesh.vertices.size());
    for (const auto& p : drawn.mesh.vertices) points.push_back(X_part * p);
    return distances_to(SignedSurface(other.mesh), X_other, points, reach_mm, threads);
  };
  view.upper_gap = gaps(*upper, {}, *lower, bite.rest.X_CM, {});
  view.lower_gap = gaps(*lower, bite.rest.X_CM, *upper, {}, X_MC);
  return view;
}

}  // namespace condyle
