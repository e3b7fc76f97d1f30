#include "tools/view_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/frame/part_names.h"
#include "sim/motion/measures.h"
#include "sim/report/motion_plots.h"
#include "tools/passing_path.h"

namespace condyle {
namespace {

constexpr const char* by_hand = "by-muscles";

/// A parameter as the panel shows it: what was published of adults, and what is used where neither
/// the case nor the person says anything (none: what the patient's joints and teeth give).
struct ShownParameter {
  const char* name;
  const char* label;
  double usual_low, usual_high;
  std::optional<double> usual = std::nullopt;
};
constexpr std::array shown_parameters = {
    // The drop of an incisal point that goes 42 to 58 mm, forward and down as in Posselt's diagram.
    ShownParameter{"opening", "Max. opening (drop)", 38, 52},
    ShownParameter{"protrusion", "Protrusion", 6, 11, 8},
    ShownParameter{"laterotrusion", "Laterotrusion", 7, 12, 9},
    ShownParameter{"retrusion", "Retrusion", 0.3, 1.4, 0.7},
    ShownParameter{"freeway", "Freeway space at rest", 2, 3, 2.5},
    ShownParameter{"hinge", "Hinge before translation", 0, 20, 12},
    ShownParameter{"inclination_left", "Condylar inclination, L", 26, 62},
    ShownParameter{"inclination_right", "Condylar inclination, R", 26, 62},
    ShownParameter{"bennett", "Bennett angle", 5, 15, 7.5},
    ShownParameter{"side_shift", "Immediate side shift", 0, 0.75, 0.3},
    ShownParameter{"disc_gap", "Condyle to fossa", 0, 0},
    ShownParameter{"speed", "Speed at the incisors", 0, 0, 40},
    ShownParameter{"chew_rate", "Chewing cycles a second", 1.2, 1.7, 1.4},
    ShownParameter{"chew_size", "Height of a chewing cycle", 0, 0, 15},
    ShownParameter{"chew_width", "Width of a chewing cycle", 0, 0, 5},
};

/// Groups of muscles as a file of excitations names them, and what they are made of.
struct MuscleGroup {
  const char* name;
  const char* label;
  std::vector<const char*> muscles;
  double usual;  // where nothing else is said
};
const std::vector<MuscleGroup>& muscle_groups() {
  static const std::vector<MuscleGroup> groups = {
      {"lt", "Temporalis, left", {"lat", "lmt", "lpt"}, 0},
      {"rt", "Temporalis, right", {"rat", "rmt", "rpt"}, 0},
      {"lm", "Masseter, left", {"ldm", "lsm"}, 0},
      {"rm", "Masseter, right", {"rdm", "rsm"}, 0},
      {"lmp", "Medial pterygoid, left", {"lmp"}, 0},
      {"rmp", "Medial pterygoid, right", {"rmp"}, 0},
      {"llp", "Lateral pterygoid, left", {"lip", "lsp"}, 0.15},
      {"rlp", "Lateral pterygoid, right", {"rip", "rsp"}, 0.15},
      {"hopen",
       "Digastric and floor of the mouth",
       {"lad", "rad", "lam", "ram", "lpm", "rpm", "lgh", "rgh"},
       0.15},
  };
  return groups;
}

double wanted_of(const MotionChoice& choice, const std::string& group, double usual) {
  const auto found = choice.excitations.find(group);
  return found == choice.excitations.end() ? usual : found->second;
}

/// Every group rises, holds and lets go, s.
constexpr double rise_s = 0.1, held_until_s = 0.6, end_s = 1.2;
std::string held_excitations(const MotionChoice& choice) {
  std::string head = "time_s", none, full;
  for (const auto& group : muscle_groups()) {
    head += std::string(",") + group.name;
    none += ",0";
    full += fmt::format(",{:.4f}", wanted_of(choice, group.name, group.usual));
  }
  return fmt::format("{}\n0{}\n{}{}\n{}{}\n{}{}\n{}{}\n", head, none, rise_s, full, held_until_s,
                     full, held_until_s + rise_s, none, end_s, none);
}

/// What the muscles of a motion were excited by, times the share of each group.
std::string scaled_excitations(const Motion& base, const MotionChoice& choice) {
  constexpr double each_s = 0.01;
  std::vector<double> shares(base.muscle_names.size(), 1.0);
  std::string text = "time_s";
  for (std::size_t m = 0; m < base.muscle_names.size(); ++m) {
    text += "," + base.muscle_names[m];
    for (const auto& group : muscle_groups())
      for (const char* name : group.muscles)
        if (base.muscle_names[m] == name) shares[m] = wanted_of(choice, group.name, 1);
  }
  text += "\n";
  const long rows = std::lround(base.duration_s / each_s);
  for (long r = 0; r <= rows; ++r) {
    const double time_s = std::min(static_cast<double>(r) * each_s, base.duration_s);
    text += fmt::format("{:.3f}", time_s);
    const MuscleStates states = base.muscles(time_s);
    for (std::size_t m = 0; m < states.size(); ++m)
      text += fmt::format(",{:.6f}", std::min(1.0, shares[m] * states[m].excitation));
    text += "\n";
  }
  return text;
}

Motion make(const MotionChoice& choice, const Scene& scene, const MotionOptions& options,
            int threads) {
  if (choice.spec == by_hand) {
    const PassingPath file("excitations");
    write_file(file.path(), held_excitations(choice));
    Motion motion = muscles_from_file(file.path(), scene.patient, options.muscles, threads);
    motion.name = "by muscles";
    return motion;
  }
  MotionSettings settings = options.settings;
  for (const auto& [name, value] : choice.parameters)
    if (const auto* parameter = motion_parameter(name))
      for (const auto member : parameter->values) settings.parameters.*member = value;
  Motion motion =
      motion_of(choice.spec, scene.patient, scene.contacts, settings, options.muscles, threads);
  if (choice.excitations.empty() || !motion.muscles) return motion;
  const PassingPath file("excitations");
  write_file(file.path(), scaled_excitations(motion, choice));
  Motion scaled = muscles_from_file(file.path(), scene.patient, options.muscles, threads);
  scaled.name = motion.name + ", muscles changed by hand";
  return scaled;
}

/// A recording's own way; else the patient's, whatever the motion does. One that cannot be is told
/// in the notes: the patient opens as far as he does unasked, or, if there is no way for him at
/// all, along the motion.
Motion opening_of(const MotionChoice& choice, const Motion& motion, const Scene& scene,
                  MotionOptions options, int threads, std::vector<std::string>& notes) {
  if (choice.spec == "opening" || motion.recording) return motion;
  MotionChoice opening{.spec = "opening", .parameters = choice.parameters, .excitations = {}};
  for (const bool asked : {true, false}) {
    if (!asked) {
      const bool was_asked = opening.parameters.erase("opening") > 0 ||
                             options.settings.parameters.opening_mm.has_value();
      options.settings.parameters.opening_mm.reset();
      if (!was_asked) break;
    }
    try {
      return make(opening, scene, options, threads);
    } catch (const InputError& error) {
      notes.push_back(fmt::format("the opening slider cannot go as asked: {}", error.what()));
    }
  }
  return motion;
}

std::vector<MotionSetting> settings_of(const MotionChoice& choice, const Motion& motion,
                                       const MotionParameters& of_case, double widest_mm) {
  if (motion.recorded) return {};
  std::vector<MotionSetting> settings;
  for (const ShownParameter& shown : shown_parameters) {
    const auto* parameter = motion_parameter(shown.name);
    if (!parameter || parameter->values.empty()) continue;
    MotionSetting one{
        .name = shown.name,
        .label = shown.label,
        .unit = parameter->unit == "mm_s"  ? "mm/s"
                : parameter->unit == "hz"  ? "Hz"
                : parameter->unit == "deg" ? "\u00b0"
                                           : parameter->unit,
        .help = parameter->help,
        .low = parameter->low,
        .high = std::min(parameter->high, std::string_view(shown.name) == "speed" ? 200.0 : 80.0),
        .usual_low = shown.usual_low,
        .usual_high = shown.usual_high,
        .value = shown.usual.value_or(0),
        .known = shown.usual.has_value()};
    const auto say = [&](double value) {
      one.value = value;
      one.known = true;
    };
    if (one.name == "opening" && choice.spec == "opening") say(widest_mm);
    for (const MotionInput& found : motion.found)
      if (found.name == one.name) one.patients = found.value;
    if (const auto& value = of_case.*(parameter->values.front())) say(*value);
    for (const MotionInput& input : motion.inputs)
      if (input.name == one.name) say(input.value);
    if (const auto mine = choice.parameters.find(one.name); mine != choice.parameters.end())
      say(mine->second);
    settings.push_back(std::move(one));
  }
  return settings;
}

std::string pair_name(const Case& patient, const PairContact& pair) {
  const auto name = [&](int part) {
    return readable_name(patient.parts[static_cast<std::size_t>(part)].name);
  };
  return name(pair.part_a) + " / " + name(pair.part_b);
}

/// Signed distance of the pairs that come nearest.
class ClearanceCurves {
 public:
  explicit ClearanceCurves(const Case& patient) : patient_(patient) {}

  void add(const FrameState& frame) {
    const auto& pairs = frame.contacts.pairs;
    if (distance_.empty()) {
      distance_.resize(pairs.size());
      for (const auto& pair : pairs) names_.push_back(pair_name(patient_, pair));
    }
    for (std::size_t i = 0; i < std::min(pairs.size(), distance_.size()); ++i)
      distance_[i].push_back(pairs[i].touching ? -pairs[i].depth_mm : pairs[i].distance_mm);
    time_s_.push_back(frame.time_s);
  }

  PlotSet plots() const {
    constexpr std::size_t most_curves = 6;
    constexpr double far_mm = 20;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < distance_.size(); ++i)
      order.emplace_back(*std::min_element(distance_[i].begin(), distance_[i].end()), i);
    std::sort(order.begin(), order.end());
    PlotPanel panel{
        {}, {.title = "Clearance (negative: overlap)", .x_label = "time, s", .y_label = "mm"}};
    panel.settings.levels = {{"contact", 0}};
    panel.settings.y_most = far_mm;
    for (std::size_t k = 0; k < std::min(order.size(), most_curves); ++k)
      if (order[k].first < far_mm)
        panel.curves.push_back({names_[order[k].second], time_s_, distance_[order[k].second]});
    return {"Clearance", {std::move(panel)}, time_s_};
  }

 private:
  const Case& patient_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> distance_;  // of each pair, over time
  std::vector<double> time_s_;
};

LineSet paths_of(const MotionSeries& series) {
  const std::array<std::pair<Eigen::Vector3d Measures::*, Eigen::Vector3f>, 3> points = {
      {{&Measures::incisor, {0.94f, 0.89f, 0.26f}},
       {&Measures::left_condyle, {0.34f, 0.71f, 0.91f}},
       {&Measures::right_condyle, {0.90f, 0.62f, 0.0f}}}};
  LineSet lines;
  lines.width_px = 2.5f;
  lines.through = 0.75f;
  for (const auto& [point, color] : points) {
    std::vector<Eigen::Vector3f> run;
    for (const Measures& m : series.measures) run.push_back((m.*point).cast<float>());
    const std::size_t before = lines.ends.size();
    add_run(lines, run);
    lines.colors.insert(lines.colors.end(), (lines.ends.size() - before) / 2, color);
  }
  return lines;
}

MotionPictures pictures_of(const MotionSeries& series, const ClearanceCurves& clearance) {
  std::vector<PlotSet> sets;
  for (auto& plot : motion_plots(series)) {
    std::string name = plot.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    sets.push_back({std::move(name), std::move(plot.panels), series.time_s});
  }
  sets.push_back(clearance.plots());
  return {std::move(sets), paths_of(series)};
}

}  // namespace

std::vector<std::string> motion_names() {
  std::vector<std::string> names = builtin_motions();
  if (std::find(names.begin(), names.end(), "opening") == names.end())
    names.insert(names.begin(), "opening");
  names.emplace_back(by_hand);
  return names;
}

ViewMotion make_view_motion(const MotionChoice& choice, const ViewPatient& patient,
                            const MotionOptions& options, int threads) {
  const Case& of = patient.scene.patient;
  ViewMotion made{.choice = choice,
                  .motion = make(choice, patient.scene, options, threads),
                  .opening = {},
                  .widest_mm = 0,
                  .settings = {},
                  .excitations = {}};
  const Motion& motion = made.motion;
  made.opening = opening_of(choice, motion, patient.scene, options, threads, made.motion.notes);
  constexpr int samples = 200;
  for (int i = 0; i <= samples; ++i) {
    const Pose X_CM = made.opening.wanted(made.opening.duration_s * i / samples);
    made.widest_mm = std::max(made.widest_mm, measure(of, X_CM).opening_mm);
  }
  made.settings = settings_of(choice, motion, of.motion, made.widest_mm);
  if (!motion.muscles) return made;
  const bool free = choice.spec == by_hand;
  for (const auto& group : muscle_groups())
    made.excitations.push_back({group.name, group.label, free ? 1.0 : 2.0,
                                wanted_of(choice, group.name, free ? group.usual : 1)});
  return made;
}

std::map<std::string, double> excitations_at(const ViewMotion& motion, double time_s) {
  constexpr double held_at_s = (rise_s + held_until_s) / 2;
  std::map<std::string, double> excitations;
  if (!motion.motion.muscles) return excitations;
  const MuscleStates states =
      motion.motion.muscles(motion.choice.spec == by_hand ? held_at_s : time_s);
  for (std::size_t m = 0; m < std::min(states.size(), motion.motion.muscle_names.size()); ++m)
    excitations[motion.motion.muscle_names[m]] = states[m].excitation;
  return excitations;
}

Pose rest_position(const MotionChoice& choice, const ViewPatient& patient,
                   const MotionOptions& options, int threads) {
  const Motion rest = make({.spec = "rest", .parameters = choice.parameters, .excitations = {}},
                           patient.scene, options, threads);
  return rest.wanted(rest.duration_s);
}

MotionPictures motion_pictures(const ViewPatient& patient, const Motion& motion,
                               SimulatorSettings settings, bool obey_contact,
                               const std::function<void(MotionPictures)>& partly,
                               const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  constexpr double each_s = 1.0 / 30;
  constexpr long most_frames = 1800;
  constexpr std::chrono::milliseconds news_every(400);
  settings.tissue = settings.face = false;
  settings.threads = 1;  // beside the simulation that is watched
  Playback playback(patient.scene, motion, settings, obey_contact);
  MotionSeries series(patient.scene, motion);
  if (!series.known_landmarks) return {};
  ClearanceCurves clearance(patient.scene.patient);
  const long frames = std::clamp(std::lround(motion.duration_s / each_s), 1L, most_frames);
  auto told = Clock::now();
  for (long i = 0; i <= frames; ++i) {
    report(progress, "walking through the motion",
           static_cast<double>(i) / static_cast<double>(frames));
    const FrameState frame =
        playback.at(motion.duration_s * static_cast<double>(i) / static_cast<double>(frames));
    series.add(frame);
    clearance.add(frame);
    if (Clock::now() - told < news_every) continue;
    partly(pictures_of(series, clearance));
    told = Clock::now();
  }
  return pictures_of(series, clearance);
}

}  // namespace condyle
