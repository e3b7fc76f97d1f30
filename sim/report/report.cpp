#include "sim/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "sim/frame/part_names.h"
#include "sim/report/expression_report.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr int cold_samples = 8;
constexpr double rounding_mm = 1e-6;  // rounding of a stop at the slack

/// An emergent quantity with its reference range in healthy adults.
Json banded(double value, double low, double high) {
  return {{"value", value}, {"band", {low, high}}, {"within", value >= low && value <= high}};
}

Json json_of(const Finding& finding) {
  Json json = {{"quantity", finding.name}, {"value", finding.value}, {"unit", finding.unit}};
  if (finding.banded()) {
    json["band"] = {finding.low, finding.high};
    json["within"] = finding.within();
  }
  if (!finding.published.empty()) json["published"] = finding.published;
  json["emergent"] = !finding.input;
  if (!finding.within()) json["why"] = finding.why;
  return json;
}

/// A quantity outside its reference range.
std::string outside_text(const Finding& finding) {
  return fmt::format("{}{}: {:.2f}{}{}, reference range {:g} to {:g}; {}", finding.name,
                     finding.input ? " (prescribed)" : "", finding.value,
                     finding.unit.empty() ? "" : " ", finding.unit, finding.low, finding.high,
                     finding.why);
}

/// "1 frame", "12 frames".
std::string frame_count(int frames, const char* more = "") {
  return fmt::format("{}{} {}", frames, more, frames == 1 ? "frame" : "frames");
}

double round_to(double value, double unit) { return std::round(value / unit) * unit; }

/// Response of the soft tissue at one frame. Empty without tissue or landmarks.
Json soft_response(const Scene& scene, const FrameState& frame) {
  Json json;
  if (!scene.tissue || frame.tissue.nodes.empty()) return json;
  const auto& marks = scene.patient.landmarks;
  const auto carried = [&](const Eigen::Vector3d& p) {
    return carried_point(*scene.tissue, frame.tissue, p);
  };
  if (const auto soft = marks.find("soft_pogonion")) {
    const Eigen::Vector3d bone = marks.find("pogonion").value_or(*soft);
    const Eigen::Vector3d bone_move = frame.poses[scene.patient.jaw.lower_arch] * bone - bone;
    const Eigen::Vector3d soft_move = carried(*soft) - *soft;
    if (bone_move.norm() > 1)
      json["soft_pogonion_follows_bone"] = soft_move.dot(bone_move) / bone_move.squaredNorm();
  }
  if (const auto nose = marks.find("pronasale"))
    json["nose_tip_moves_mm"] = (carried(*nose) - *nose).norm();
  const auto upper = marks.find("labrale_superius"), lower = marks.find("labrale_inferius");
  if (upper && lower) {
    const double gap = (carried(*upper) - carried(*lower)).norm() - (*upper - *lower).norm();
    json["lip_gap_mm"] = gap;
    if (frame.measures.opening_mm > 1)
      json["lip_gap_over_opening"] = gap / frame.measures.opening_mm;
  }
  return json;
}

Json json_of(const RecordingFacts& facts) {
  Json json = {{"format", facts.format},
               {"rows", facts.rows},
               {"rows_without_pose", facts.rows_without_pose},
               {"median_step_s", facts.median_step_s},
               {"gaps", Json::array()}};
  for (const auto& gap : facts.gaps)
    json["gaps"].push_back({{"after_s", gap.after_s}, {"length_s", gap.length_s}});
  if (facts.has_markers)
    json["marker_residual_mm"] = {{"rms", facts.residual_rms_mm}, {"max", facts.residual_max_mm}};
  if (facts.smooth_hz > 0) json["smooth_hz"] = facts.smooth_hz;
  return json;
}

Json json_of(const std::vector<Extreme>& extremes) {
  Json json;
  for (const Extreme& extreme : extremes)
    json[extreme.name] = {
        {"value", extreme.value}, {"unit", extreme.unit}, {"time_s", extreme.time_s}};
  return json;
}

Json json_of(const HelicalAxis& axis) {
  const auto list = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  return {{"direction", list(axis.direction)},
          {"point_mm", list(axis.point)},
          {"slide_mm", axis.slide_mm}};
}

/// Parameters that the motion does not show are omitted.
Json json_of(const JointFit& fit) {
  Json json;
  const auto put = [](Json& where, const char* name, const std::optional<double>& value) {
    if (value) where[name] = *value;
  };
  for (const auto& [name, side] : {std::pair{"left", &fit.left}, std::pair{"right", &fit.right}}) {
    Json& where = json[name] = {{"forward_travel_mm", side->travel_mm}};
    put(where, "inclination_deg", side->inclination_deg);
    put(where, "bennett_deg", side->bennett_deg);
    put(where, "immediate_side_shift_mm", side->side_shift_mm);
  }
  put(json, "hinge_deg", fit.hinge_deg);
  put(json, "deg_per_mm", fit.deg_per_mm);
  json["reference_plane"] = fit.to_frankfort ? "Frankfort" : "horizontal";
  return json;
}

}  // namespace

StageSummary summarise(std::vector<double> ms) {
  if (ms.empty()) return {};
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double q) {
    return ms[static_cast<std::size_t>(std::ceil(q * static_cast<double>(ms.size()))) - 1];
  };
  return {at(0.5), at(0.95)};
}

MotionReport::MotionReport(const Scene& scene, const Motion& motion,
                           const SimulatorSettings& settings)
    : scene_(scene),
      motion_(motion),
      settings_(settings),
      series_(scene, motion),
      pairs_(scene.contacts.at_rest().pairs.size()) {
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    pairs_[i].rest_depth = scene.contacts.at_rest().pairs[i].rest_depth_mm;
}

void MotionReport::add(const FrameState& frame) {
  series_.add(frame);
  const auto& rest = scene_.patient.landmarks;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto& pair = frame.contacts.pairs[i];
    auto& record = pairs_[i];
    const double distance = pair.touching ? 0 : pair.distance_mm;
    const double beyond = pair.depth_mm - pair.rest_depth_mm;
    if (pair.touching) {
      ++record.touching_frames;
      if (record.first_touch < 0) record.first_touch = frames_;
    }
    if (beyond > settings_.contact.slack_mm + rounding_mm) ++record.penetrating_frames;
    if (record.worst_frame < 0 || distance < record.min_distance ||
        (distance == record.min_distance && pair.depth_mm > record.deepest))
      record.worst_frame = frames_;
    record.min_distance = std::min(record.min_distance, distance);
    record.deepest = std::max(record.deepest, pair.depth_mm);
  }
  if (frame.stopped) {
    ++stopped_frames_;
    if (first_stopped_ < 0) first_stopped_ = frames_;
    const auto incisor = rest.find("lower_incisal_point").value_or(Eigen::Vector3d::Zero());
    const BodyId jaw = scene_.patient.jaw.lower_arch;
    const Eigen::Vector3d target = placed(scene_.patient.bodies, frame.X_PB_target)[jaw] * incisor;
    contact_deviation_mm_ =
        std::max(contact_deviation_mm_, (frame.poses[jaw] * incisor - target).norm());
  }
  if (frame.tissue.inverted_prisms > 0) ++inverted_frames_;
  if (!frame.tissue.converged) ++unconverged_frames_;
  if (frame.tissue.reused) ++reused_frames_;
  tissue_penetration_mm_ = std::max(tissue_penetration_mm_, frame.tissue.penetration_mm);
  tissue_slip_mm_ = std::max(tissue_slip_mm_, frame.tissue.slip_mm);
  tissue_contact_error_mm_ = std::max(tissue_contact_error_mm_, frame.tissue.contact_error_mm);
  max_rotation_deg_ = std::max(max_rotation_deg_, frame.measures.rotation_deg);
  if (const auto left = rest.find("left_condyle"))
    left_travel_mm_ = std::max(left_travel_mm_, (frame.measures.left_condyle - *left).norm());
  if (const auto right = rest.find("right_condyle"))
    right_travel_mm_ = std::max(right_travel_mm_, (frame.measures.right_condyle - *right).norm());
  if (frames_ == 0 || frame.measures.opening_mm > widest_.measures.opening_mm) {
    widest_ = frame;
    widest_.face.clear();
    widest_frame_ = frames_;
  }
  const double next_sample = motion_.duration_s * (static_cast<double>(samples_.size()) + 0.5) /
                             static_cast<double>(cold_samples);
  if (samples_.size() < cold_samples && frame.time_s >= next_sample) {
    samples_.push_back(frame);
    samples_.back().face.clear();
  }
  iterations_.push_back(frame.tissue.iterations);
  const auto strength = [](const TissueState& tissue) {
    return std::accumulate(tissue.excitation.begin(), tissue.excitation.end(), 0.0);
  };
  if (const double now = strength(frame.tissue); now > 0 && now >= strength(expressed_))
    expressed_ = frame.tissue, expressed_time_s_ = frame.time_s;
  for (std::size_t i = 0; i < stage_names.size(); ++i)
    stage_ms_[std::string(stage_names[i])].push_back(frame.times.ms[i]);
  ++frames_;
}

Json MotionReport::motion_json() const {
  Json json = {
      {"name", motion_.name}, {"recorded", motion_.recorded}, {"duration_s", motion_.duration_s}};
  for (const auto& phase : motion_.phases)
    json["phases"].push_back(
        {{"name", phase.name}, {"start_s", phase.start_s}, {"end_s", phase.end_s}});
  for (const auto& input : motion_.inputs)
    json["inputs"].push_back({{"name", input.name}, {"value", input.value}, {"unit", input.unit}});
  json["notes"] = motion_.notes;
  if (motion_.recording) json["recording"] = json_of(*motion_.recording);
  if (motion_.recorded)
    if (const auto joint = fit_joint(scene_.patient, motion_)) json["joint"] = json_of(*joint);
  return json;
}

std::vector<Finding> MotionReport::all_findings() const {
  std::vector<Finding> found = findings(scene_, motion_, series_);
  for (Finding& finding : expression().findings) found.push_back(std::move(finding));
  return found;
}

/// Findings, and those outside their reference range, prescribed ones too.
void MotionReport::add_findings(Json& json) const {
  Json list = Json::array(), outside = Json::array();
  for (const auto& finding : all_findings()) {
    list.push_back(json_of(finding));
    if (!finding.within()) outside.push_back(outside_text(finding));
  }
  json["findings"] = list;
  if (too_coarse(series_) && !motion_.phases.empty())
    json["findings_note"] =
        "findings within a phase need at least 20 frames per second (--fps, --frames)";
  json["outside_bands"] = outside;
}

Json MotionReport::contact_json() const {
  Json pairs = Json::array();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto& rest = scene_.contacts.at_rest().pairs[i];
    const auto& record = pairs_[i];
    const auto name = [&](int part) {
      return scene_.patient.parts[static_cast<std::size_t>(part)].name;
    };
    Json pair = {{"a", name(rest.part_a)},
                 {"b", name(rest.part_b)},
                 {"overlap_at_rest_mm", record.rest_depth},
                 {"distance_at_rest_mm", rest.touching ? 0 : rest.distance_mm},
                 {"min_distance_mm", record.min_distance},
                 {"deepest_mm", record.deepest},
                 {"beyond_rest_mm", std::max(0.0, record.deepest - record.rest_depth)},
                 {"touching_frames", record.touching_frames},
                 {"penetrating_frames", record.penetrating_frames}};
    if (record.first_touch >= 0) pair["first_touching_frame"] = record.first_touch;
    pairs.push_back(pair);
  }
  Json json = {{"pairs", pairs}, {"stopped_frames", stopped_frames_}};
  if (first_stopped_ >= 0) {
    json["first_stopped_frame"] = first_stopped_;
    json["contact_deviation_mm"] = contact_deviation_mm_;
  }
  return json;
}

Json MotionReport::tissue_json() const {
  const auto& made = summary(*scene_.tissue);
  Json tissue = {{"nodes", made.nodes},
                 {"springs", made.springs},
                 {"prisms", made.prisms},
                 {"layers", made.layers},
                 {"attached_to_cranium", made.attached_to_cranium},
                 {"attached_to_mandible", made.attached_to_mandible},
                 {"boundary", made.boundary},
                 {"lips_cut", made.lips_cut},
                 {"frames_with_inverted_prisms", inverted_frames_},
                 {"frames_not_converged", unconverged_frames_},
                 {"frames_reusing_previous_tissue", reused_frames_},
                 {"at_rest",
                  {{"largest_force_N", made.rest_force_N},
                   {"moves_mm", made.rest_move_mm},
                   {"overlap_mm", made.rest_overlap_mm},
                   {"lip_points_left_out", made.lip_points_left_out}}},
                 {"max_penetration_mm", tissue_penetration_mm_},
                 {"max_slip_mm", tissue_slip_mm_},
                 {"max_contact_error_mm", tissue_contact_error_mm_},
                 {"at_widest_opening", soft_response(scene_, widest_)},
                 {"notes", made.notes}};
  std::vector<double> warm, cold;
  for (const auto& frame : samples_) {
    TissueBudget budget = settings_.tissue_budget;
    budget.threads = settings_.threads;
    warm.push_back(frame.tissue.iterations);
    cold.push_back(
        solve_tissue(*scene_.tissue, rest_tissue(*scene_.tissue), frame.tissue.X_CB, budget)
            .iterations);
  }
  const double warm_median = summarise(warm).median, cold_median = summarise(cold).median;
  if (cold_median > 0)
    tissue["iterations"] = {{"warm_median", warm_median},
                            {"cold_median", cold_median},
                            {"warm_over_cold", warm_median / cold_median}};
  return tissue;
}

namespace {

/// The operation before the motion.
Json plan_json_of(const ScenePlan& plan) {
  Json json{{"name", plan.name}, {"hash", plan.hash}, {"notes", plan.notes}};
  for (const auto& muscle : plan.muscles)
    json["muscle_lengths"].push_back({{"muscle", muscle.muscle},
                                      {"before_mm", round_to(muscle.before_mm, 1e-3)},
                                      {"after_mm", round_to(muscle.after_mm, 1e-3)}});
  return json;
}

}  // namespace

std::string MotionReport::json() const {
  Json json;
  json["about"] = "Condyle; for research and education, not for clinical use";
  json["case"] = scene_.patient.name;
  if (scene_.plan) json["plan"] = plan_json_of(*scene_.plan);
  json["motion"] = motion_json();
  json["frames"] = frames_;
  json["step_s"] = settings_.step_s;
  const auto& w = widest_.measures;
  json["opening"] = {{"max_opening_mm", w.opening_mm},
                     {"frame", widest_frame_},
                     {"time_s", widest_.time_s},
                     {"interincisal_mm", w.interincisal_mm},
                     {"max_rotation_deg", banded(max_rotation_deg_, 28, 45)},
                     {"left_condylar_travel_mm", banded(left_travel_mm_, 10, 20)},
                     {"right_condylar_travel_mm", banded(right_travel_mm_, 10, 20)}};
  if (scene_.patient.landmarks.find("lower_incisal_point"))
    json["opening"]["incisal_displacement_mm"] = banded(w.incisal_displacement_mm, 42, 58);
  if (w.helical_axis.known) json["opening"]["helical_axis"] = json_of(w.helical_axis);

  if (series_.known_landmarks) json["measures"] = json_of(extremes(series_));

  add_findings(json);
  json["warnings"] = physiology_warnings(series_);
  if (!expressed_.excitation.empty()) json["expression"] = expression_json(expression());

  json["contact"] = contact_json();
  if (scene_.tissue) json["tissue"] = tissue_json();
  Json stages;
  for (const auto name : stage_names) {
    const auto times = summarise(stage_ms_.at(std::string(name)));
    stages[std::string(name)] = {{"median", round_to(times.median, 1e-4)},
                                 {"p95", round_to(times.p95, 1e-4)}};
  }
  json["stage_ms"] = stages;
  json["patient_notes"] = scene_.patient.notes;
  json["contact_notes"] = scene_.contacts.notes();
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string MotionReport::contact_text() const {
  std::string text;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto& rest = scene_.contacts.at_rest().pairs[i];
    const auto& a = scene_.patient.parts[static_cast<std::size_t>(rest.part_a)].name;
    const auto& b = scene_.patient.parts[static_cast<std::size_t>(rest.part_b)].name;
    const auto& record = pairs_[i];
    text += fmt::format("{} and {}: ", readable_name(a), readable_name(b));
    if (record.rest_depth > 0)
      text += fmt::format("overlap {:.2f} mm at rest, ", record.rest_depth);
    if (record.penetrating_frames > 0)
      text +=
          fmt::format("up to {:.2f} mm deeper than at rest, in {}\n",
                      record.deepest - record.rest_depth, frame_count(record.penetrating_frames));
    else if (record.touching_frames > 0)
      text += fmt::format("in contact in {}, never deeper than at rest\n",
                          frame_count(record.touching_frames));
    else
      text += fmt::format("at least {:.2f} mm apart\n", record.min_distance);
  }
  return text;
}

std::string MotionReport::tissue_text() const {
  std::string text = fmt::format("soft tissue: {} nodes, {} prisms; inverted prisms in {}\n",
                                 summary(*scene_.tissue).nodes, summary(*scene_.tissue).prisms,
                                 frame_count(inverted_frames_));
  text += fmt::format(
      "it slides along bone and teeth by up to {:.1f} mm and penetrates them by up to {:.2f} mm\n",
      tissue_slip_mm_, tissue_penetration_mm_);
  if (reused_frames_ > 0)
    text += fmt::format("its solve failed in {}; these show the tissue of the previous frame\n",
                        frame_count(reused_frames_));
  if (unconverged_frames_ > reused_frames_)
    text += fmt::format(
        "it did not converge in {} (tissue_converged 0 in trace.csv); contact error up to "
        "{:.2f} mm\n",
        frame_count(unconverged_frames_ - reused_frames_, reused_frames_ > 0 ? " more" : ""),
        tissue_contact_error_mm_);
  return text;
}

std::string MotionReport::text() const {
  const auto& m = widest_.measures;
  const Landmarks& landmarks = scene_.patient.landmarks;
  std::string text = fmt::format("{} frames; ", frames_);
  if (landmarks.find("lower_incisal_point")) {
    text += fmt::format(
        "maximum opening {:.1f} mm (vertical, lower incisal point; displacement {:.1f} mm",
        m.opening_mm, m.incisal_displacement_mm);
    if (landmarks.find("upper_incisal_point"))
      text += fmt::format("; interincisal distance {:.1f} mm", m.interincisal_mm);
    text += fmt::format(") at {:.2f} s, ", widest_.time_s);
  }
  text += fmt::format("rotation {:.1f} deg, condylar travel {:.1f} mm left, {:.1f} mm right\n",
                      max_rotation_deg_, left_travel_mm_, right_travel_mm_);
  int emergent = 0, within = 0, inputs = 0;
  std::string outside;
  for (const auto& finding : all_findings()) {
    if (!finding.banded()) continue;
    if (!finding.within()) outside += "  " + outside_text(finding) + "\n";
    ++(finding.input ? inputs : emergent);
    within += !finding.input && finding.within();
  }
  if (emergent > 0)
    text += fmt::format("{} of {} emergent quantities are within their reference ranges{}\n",
                        within, emergent,
                        inputs > 0 ? fmt::format("; {} more follow from the inputs", inputs) : "");
  text += outside;
  for (const auto& warning : physiology_warnings(series_)) text += "warning: " + warning + "\n";
  text += contact_text();
  const bool penetrates = std::any_of(pairs_.begin(), pairs_.end(), [](const PairRecord& record) {
    return record.penetrating_frames > 0;
  });
  if (motion_.recorded && penetrates && stopped_frames_ == 0)
    text +=
        "a recorded motion is played back unchanged; --respect-contact stops it where bones meet\n";
  constexpr double glide_mm = 0.05;  // guidance of gliding teeth stays below this
  if (contact_deviation_mm_ > glide_mm)
    text += fmt::format(
        "contact deflects the jaw from the prescribed motion in {}, first in frame {}, by up to "
        "{:.2f} mm at the incisors\n",
        frame_count(stopped_frames_), first_stopped_, contact_deviation_mm_);
  if (scene_.tissue) text += tissue_text();
  return text;
}

}  // namespace condyle
