#include "render/window/view_state_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "engine/core/files.h"

namespace condyle {

namespace {

/// Settings of the tree and of the picture's appearance.
nlohmann::json edits_of(const ViewState& view) {
  const auto parts = [](const std::vector<PartView>& views) {
    nlohmann::json list = nlohmann::json::array();
    for (const PartView& one : views) list.push_back(one.shown ? one.opacity : 0);
    return list;
  };
  const auto levels = [](const std::vector<ExpressionLevel>& expression) {
    nlohmann::json json = nlohmann::json::object();
    for (const ExpressionLevel& one : expression) json[one.name] = {one.left, one.right};
    return json;
  };
  // Complete: a new field of Look does not compile until it is added here.
  const auto& [clip, clip_skin, clip_from, clip_fraction, cut_away, cut_at, cut_radius_mm, ghost,
               wireframe, patches, paths, axes, springs, prisms, bone_springs, displacement,
               facial_muscles, muscle_labels, scale_bar, side_letters, folds, life, wipe, wipe_at,
               mirrored] = view.look;
  return {{"clip", clip},
          {"clip_from", std::string(1, clip_from)},
          {"clip_share", clip_fraction},
          {"clip_skin", clip_skin},
          {"cut_away", cut_away},
          {"cut_at", static_cast<int>(cut_at)},
          {"cut_radius_mm", cut_radius_mm},
          {"ghost", ghost},
          {"wipe", wipe},
          {"wipe_at", wipe_at},
          {"mirrored", mirrored},
          {"distances", view.distances},
          {"patches", patches},
          {"displacement", displacement},
          {"wireframe", wireframe},
          {"paths", paths},
          {"axes", axes},
          {"springs", springs},
          {"prisms", prisms},
          {"bone_springs", bone_springs},
          {"facial_muscles", facial_muscles},
          {"muscle_labels", muscle_labels},
          {"scale_bar", scale_bar},
          {"letters", side_letters},
          {"folds", folds},
          {"life", life},
          {"shadows", view.shadows},
          {"mark_contacts", view.mark_contacts},
          {"obey_contact", view.obey_contact},
          {"skin_opacity", view.skin_opacity},
          {"opening_mm", view.opening_mm ? nlohmann::json(*view.opening_mm) : nullptr},
          {"parts", parts(view.parts)},
          {"muscles", parts(view.muscles)},
          {"layers", parts(view.layers)},
          {"motion", view.motion.spec},
          {"expression", levels(view.expression)},
          {"parameters", view.motion.parameters},
          {"excitations", view.motion.excitations}};
}

/// The CT that is imported.
nlohmann::json ct_of(const CtView& ct) {
  constexpr const char* stages[] = {"listing", "series", "reading", "slices", "making"};
  const auto& [cross, threshold_hu, seeds, turn_deg, tilt_deg] = ct.chosen;
  nlohmann::json json = {{"stage", stages[static_cast<std::size_t>(ct.stage)]},
                         {"name", ct.name},
                         {"best", ct.best},
                         {"notes", ct.notes},
                         {"volume_notes", ct.volume_notes},
                         {"threshold_hu", threshold_hu},
                         {"seeds", seeds.size()},
                         {"seed_remark", ct.seed_remark},
                         {"turn_deg", turn_deg},
                         {"tilt_deg", tilt_deg}};
  json["cross_mm"] = {cross.x(), cross.y(), cross.z()};
  for (const CtSeriesItem& one : ct.series) json["series"].push_back(one.facts);
  for (const CtSliceView& slice : ct.slices) json["slices"].push_back(slice.number);
  return json;
}

}  // namespace

void ViewStateFile::update(const Window& window, const FrameState* frame,
                           const std::string& busy_with) {
  if (file_.empty()) return;
  const auto list = [](const Eigen::Vector3d& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  // Coordinate frames: the room R, the cranium C, the mandible M.
  const auto pose = [&](const Pose& X) {
    return nlohmann::json{{"mm", list(X.t)},
                          {"quaternion_wxyz", {X.R.w(), X.R.x(), X.R.y(), X.R.z()}}};
  };
  const auto shown = [](const std::vector<PartView>& parts) {
    return std::count_if(parts.begin(), parts.end(), [](const PartView& p) { return p.shown; });
  };
  const ViewState& view = window.view();
  const PictureStatistics& pictures = window.pictures();
  nlohmann::json json = {
      {"busy_with", busy_with},
      {"playing", view.playing},
      {"time_s", view.time_s},
      {"motion", view.motion.spec},
      {"tool", static_cast<int>(view.tool)},
      {"measured", view.measured.size()},
      {"landmarks", view.landmarks.size()},
      {"skin_opacity", view.skin_opacity},
      {"muscles_shown", shown(view.muscles)},
      {"layers_shown", shown(view.layers)},
      {"camera_direction", list(window.camera().direction)},
      {"camera",
       {{"target_mm", list(window.camera().target)},
        {"up", list(window.camera().up)},
        {"distance_mm", window.camera().distance_mm}}},
      {"speed", view.speed},
      {"loop", view.loop},
      {"panels",
       {static_cast<int>(view.tab), static_cast<int>(view.left_tab), view.plots, view.plot_set}},
      {"session", window.scene().session.string()},
      {"pictures_per_second", pictures.pictures_per_second},
      {"picture_ms", pictures.picture_ms},
      {"render_scale", pictures.render_scale},
      {"samples", pictures.samples},
      {"picture_finished", pictures.finished},
      {"longest_away_ms", std::round(pictures.longest_away_ms)},
      {"longest_work_ms", std::round(pictures.longest_work_ms)}};
  json["edits"] = edits_of(view);
  json["measured_points"] = nlohmann::json::array();
  for (const PinnedPoint& point : view.measured)
    json["measured_points"].push_back({point.part, point.triangle.x(), point.triangle.y(),
                                       point.triangle.z(), list(point.barycentric)});
  json["case"] = {{"name", window.scene().case_name},
                  {"folder", window.scene().case_folder.string()}};
  json["notes"] = window.scene().notes;
  json["drawn_points"] = view.drawn_cut.points.size();
  if (window.scene().ct) json["ct"] = ct_of(*window.scene().ct);
  if (view.chosen < window.scene().bodies.size())
    json["chosen"] = window.scene().parts[window.scene().bodies[view.chosen].part].name;
  if (view.selected) json["selected"] = window.scene().parts[*view.selected].name;
  json["recent"] = nlohmann::json::array();
  for (const auto& path : window.scene().recent) json["recent"].push_back(path.string());
  if (const std::string trouble = window.trouble(); !trouble.empty()) json["trouble"] = trouble;
  if (const Question* question = window.question()) json["asked"] = question->words;
  if (!window.said().empty()) json["said"] = window.said();
  if (const auto hand = view.hands.X_CM_target()) json["X_CM_wanted"] = pose(*hand);
  if (const auto skull = view.hands.at(cranium_body)) {
    json["X_RC_wanted"] = pose(*skull);
    json["X_RC"] = pose(view.hands.X_RC(frame ? frame->poses[view.hands.jaw] : Pose{}));
  }
  for (const Landmark& landmark : view.landmarks)
    json["landmark_mm"][landmark.name] = list(landmark.at_rest);
  if (frame) {
    for (const Pose& X_CB : frame->poses.X_CB) json["body_mm"].push_back(list(X_CB.t));
    json["frame"] = {{"time_s", frame->time_s},
                     {"mandible_mm", list(frame->poses[view.hands.jaw].t)},
                     {"stopped", frame->stopped},
                     {"excitation", std::accumulate(frame->tissue.excitation.begin(),
                                                    frame->tissue.excitation.end(), 0.0)},
                     {"opening_mm", frame->measures.opening_mm},
                     {"penetration_mm", frame->contacts.max_penetration_mm()}};
  }
  for (const DrawnItem& item : window.items()) {
    json["items"][item.name] = {item.rect.x, item.rect.y, item.rect.width, item.rect.height};
    if (!item.words.empty()) json["words"][item.name] = item.words;
  }
  const ViewRect rect = window.view_rect();
  json["view"] = {rect.x, rect.y, rect.width, rect.height};
  std::string text = json.dump(1);
  if (text == written_) return;
  write_file(file_, text);
  written_ = std::move(text);
}

}  // namespace condyle
