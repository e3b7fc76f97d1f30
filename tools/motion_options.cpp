#include "tools/motion_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "engine/core/error.h"
#include "sim/case/pair_rules.h"
#include "sim/muscles/default_face_muscles.h"
#include "sim/muscles/default_muscles.h"
#include "sim/muscles/expression.h"
#include "sim/muscles/face_weakness.h"
#include "sim/operated/graft_path.h"
#include "sim/operated/operated_scene.h"
#include "sim/plan/plan_file.h"
#include "tools/common.h"
#include "tools/pair_options.h"

namespace condyle {
namespace {

void add_parameters(CLI::App& command, MotionOptions& motion) {
  begin_group(command, "Motion");
  for (const auto& entry : motion_parameter_names()) {
    std::string name = "--" + entry.name;
    std::replace(name.begin(), name.end(), '_', '-');
    const std::string unit = entry.unit.empty() || entry.unit == "mm_s" ? "" : ", " + entry.unit;
    in_range(command.add_option_function<double>(
                 name,
                 [&motion, &entry](const double& value) {
                   for (const auto member : entry.values)
                     motion.settings.parameters.*member = value;
                 },
                 entry.help + unit),
             entry.low, entry.high);
  }
}

void add_muscles(CLI::App& command, MuscleMotionSettings& muscles) {
  begin_group(command, "Muscles");
  static const Choices<MuscleLaw> laws = {{"hill", MuscleLaw::hill}, {"peck", MuscleLaw::peck}};
  command
      .add_option_function<std::string>(
          "--muscle-law",
          [&muscles](const std::string& word) {
            muscles.law.law = chosen(laws, "--muscle-law", word);
          },
          "hill: force falls with speed, and activation lags; peck: neither. Default hill")
      ->type_name(words_of(laws));
  command
      .add_option("--hyoid", muscles.hyoid,
                  "Fixed (the default), free, or a CSV of its displacement from rest: "
                  "time_s,x_mm,y_mm,z_mm")
      ->type_name("fixed|free|FILE");
  using Side = BolusSettings::Side;
  static const Choices<Side> sides = {
      {"none", Side::none}, {"left", Side::left}, {"right", Side::right}};
  command
      .add_option_function<std::string>(
          "--bolus",
          [&muscles](const std::string& word) {
            muscles.bolus.side = chosen(sides, "--bolus", word);
          },
          "Food between the back teeth; default none")
      ->type_name(words_of(sides));
  in_range(command.add_option("--bolus-size", muscles.bolus.size_mm,
                              "Thickness of the food, mm; default 10"),
           1, 40);
  in_range(command.add_option("--bolus-resistance", muscles.bolus.resistance_N,
                              "Force at which the food is bitten through, N; default 35"),
           0, 300);
}

Motion jaw_motion_of(const MotionOptions& options, const Scene& scene, int threads) {
  if (options.motion.empty())
    return {.name = "rest",
            .duration_s = options.settings.duration_s,
            .recorded = false,
            .target = [](double) { return Pose{}; },
            .notes = {}};
  if (is_insertion_path(options.motion))
    return insertion_path_motion(options.motion, scene, options.settings.duration_s, threads);
  return motion_of(options.motion, scene.patient, scene.contacts, options.settings, options.muscles,
                   threads);
}

}  // namespace

void add_motion(CLI::App& command, MotionOptions& motion) {
  command.add_option("CASE", motion.patient,
                     "Folder with case.json (default: the built-in patient)");
  command
      .add_option("--motion", motion.motion,
                  "A built-in motion (" + CLI::detail::join(builtin_motions(), ", ") +
                      "), movements and expressions in words (\"open 40; close; smile 0.8\") or a "
                      "file of them "
                      "(*.motion), a recorded motion, muscles:FILE, or inverse:MOTION (muscles "
                      "that follow it), or path:GRAFT (the insertion path of a planned graft): "
                      "condyle help "
                      "motions, recordings, muscles, grafts")
      ->type_name("MOTION");
  in_range(command.add_option("--duration", motion.settings.duration_s,
                              "Duration of the whole motion, s; default: its own (opening: 3)"),
           0.2, 3600);
  add_plan_file(command, motion.plan);
}

void add_expression(CLI::App& command, MotionOptions& motion) {
  command
      .add_option(
          "--expression", motion.expression,
          "Expression of the face, alone or during the motion: " +
              CLI::detail::join(builtin_expressions(), ", ") +
              ", or action units (AU12), each with a strength from 0 to 1 (smile:0.8) and a side "
              "(smile:1:left), several joined by +; or excitations of its muscles over time "
              "(*.csv): condyle help muscles")
      ->type_name("NAME[:STRENGTH[:SIDE]]+...|FILE");
  command
      .add_option("--weakness", motion.weakness,
                  "Remaining strength of the muscles of the face, 0 paralysed to 1 healthy, of a "
                  "side or a muscle: right:0.2, left_zygomaticus_major:0; may be given several "
                  "times")
      ->type_name("SIDE|MUSCLE:STRENGTH");
}

void add_plan_file(CLI::App& command, std::filesystem::path& plan) {
  command
      .add_option("--plan", plan,
                  "The patient after the operation of this plan: condyle help planning")
      ->type_name("FILE");
}

std::optional<Plan> plan_of(const std::filesystem::path& file) {
  if (file.empty()) return {};
  return load_plan(file);
}

std::filesystem::path case_of(const MotionOptions& options) {
  return case_of(options.patient, plan_of(options.plan));
}

Scene scene_of(const MotionOptions& options, Case patient, const SimulatorSettings& settings,
               const Progress& progress) {
  return make_scene(std::move(patient), plan_of(options.plan), settings, progress);
}

void add_pairs(CLI::App& command, MotionOptions& motion) {
  begin_group(command, "Contact");
  command
      .add_option("--pair", motion.pairs,
                  "What two parts may do to each other (" + known_policies() +
                      "; * is any part), e.g. skull,mandible,guided,gap=1.5 or "
                      "segment,*,forbidden,margin=2; may be given several times")
      ->type_name("A,B,POLICY[,gap=MM][,margin=MM]");
}

void add_sliding(CLI::App& command, MotionOptions& motion) {
  begin_group(command, "Contact");
  command.add_flag("--respect-contact", motion.respect_contact,
                   "A recorded motion, too, slides where bones meet, as built-in motions do");
  in_range(command.add_option("--friction", motion.friction,
                              "Coulomb coefficient of sliding bone and teeth; default 0"),
           0, 2);
}

void add_motion_details(CLI::App& command, MotionOptions& motion) {
  add_parameters(command, motion);
  add_muscles(command, motion.muscles);
}

SimulatorSettings simulator_settings(const MotionOptions& options, const CommonOptions& common) {
  SimulatorSettings settings;
  settings.threads = common.threads;
  settings.tissue = options.tissue.simulated;
  settings.tissue_model.surface_nodes = options.tissue.surface_nodes;
  settings.tissue_model.plan = parse_tissue(options.tissue);
  settings.tissue_model.upper_face =
      settings.tissue &&
      (motion_moves_upper_face(options.motion) ||
       (!options.expression.empty() && expression_moves_upper_face(options.expression)));
  settings.contact.friction = options.friction;
  for (const auto& pair : options.pairs) settings.contact.pair_rules.push_back(parse_pair(pair));
  return settings;
}

void check_motion(const MotionOptions& options) {
  check_weakness(options.weakness);
  if (!options.weakness.empty() && !options.tissue.simulated)
    throw InputError("--weakness " + options.weakness.front() + ": needs the soft tissue");
  if (!options.expression.empty()) {
    check_expression(options.expression);
    if (!options.tissue.simulated)
      throw InputError("--expression " + options.expression + ": needs the soft tissue");
  }
  if (options.motion.empty()) {
    if (options.expression.empty()) throw InputError("--motion is required, or --expression");
  } else if (!is_insertion_path(options.motion))
    check_motion(options.motion, options.settings, options.muscles);
  else if (options.plan.empty())
    throw InputError("--motion " + options.motion + ": needs a --plan with a graft");
  plan_of(options.plan);  // refuses a file that is not a plan
}

void check_motion(const MotionOptions& options, const Case& patient) {
  if (!options.motion.empty()) check_excitations(options.motion, patient);
  if (options.expression.empty()) return;
  if (const std::string mark = missing_face_landmark(patient); !mark.empty())
    throw InputError("--expression " + options.expression +
                     ": the patient has no muscles of the face: the landmark " + mark +
                     " is missing");
}

namespace {

/// The motion with the jaw's movements and the expressions, of healthy muscles.
Motion healthy_motion_of(const MotionOptions& options, const Scene& scene, int threads) {
  Motion motion = jaw_motion_of(options, scene, threads);
  if (motion.expression && !scene.tissue) {
    motion.expression = {};
    motion.notes.emplace_back(
        "the motion's expressions are left out: there is no soft tissue, and they do not move "
        "bones or teeth");
  }
  if (options.expression.empty()) return motion;
  if (motion.expression)
    throw InputError("--expression " + options.expression + ": the motion " + motion.name +
                     " has expressions of its own; give one of both");
  if (!scene.tissue)
    throw InputError("--expression " + options.expression + ": the patient has no face");
  const Expression expression = make_expression(options.expression, face_muscles_of(*scene.tissue));
  if (motion.duration_s <= 0) motion.duration_s = std::max(expression.duration_s, 0.2);
  motion.expression = expression.at;
  motion.notes.insert(motion.notes.end(), expression.notes.begin(), expression.notes.end());
  return motion;
}

}  // namespace

Motion motion_of(const MotionOptions& options, const Scene& scene, int threads) {
  Motion motion = healthy_motion_of(options, scene, threads);
  if (options.weakness.empty()) return motion;
  if (!scene.tissue)
    throw InputError("--weakness " + options.weakness.front() + ": the patient has no face");
  const FaceStrengths strengths =
      muscle_strengths(options.weakness, face_muscles_of(*scene.tissue));
  if (!motion.expression)
    throw InputError("--weakness " + options.weakness.front() +
                     ": needs an expression, by --expression or in the words of --motion");
  motion.expression = [healthy = motion.expression, strengths](double time_s) {
    return weakened(healthy(time_s), strengths);
  };
  motion.lid_strength = strengths.lids;
  return motion;
}

}  // namespace condyle
