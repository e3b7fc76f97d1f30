#include "sim/session/session_motion.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/temporary_path.h"
#include "sim/dynamics/muscle_motion.h"
#include "sim/motion/measure_pose.h"
#include "sim/operated/graft_path.h"
#include "sim/session/motion_settings.h"
#include "sim/session/muscle_groups.h"

namespace condyle {
namespace {

constexpr const char* by_hand = "by-muscles";

Motion make(const MotionChoice& choice, const Scene& scene, const SessionSettings& options) {
  if (choice.spec == by_hand) {
    const TemporaryPath file("excitations");
    write_file(file.path(), held_excitations(choice));
    Motion motion =
        muscles_from_file(file.path(), scene.patient, options.muscles, options.simulator.threads);
    motion.name = "by muscles";
    return motion;
  }
  if (is_insertion_path(choice.spec))
    return insertion_path_motion(choice.spec, scene, options.motion.duration_s,
                                 options.simulator.threads);
  MotionSettings settings = options.motion;
  for (const auto& [name, value] : choice.parameters)
    if (const auto* parameter = motion_parameter(name))
      for (const auto member : parameter->values) settings.parameters.*member = value;
  Motion motion = motion_of(choice.spec, scene.patient, scene.contacts, settings, options.muscles,
                            options.simulator.threads);
  if (choice.excitations.empty() || !motion.muscles) return motion;
  const TemporaryPath file("excitations");
  write_file(file.path(), scaled_excitations(motion, choice));
  Motion scaled =
      muscles_from_file(file.path(), scene.patient, options.muscles, options.simulator.threads);
  scaled.name = motion.name + ", muscles changed by hand";
  return scaled;
}

/// The motion along which the mouth opens: the recording itself, else the patient's own opening,
/// regardless of the motion. Where that is impossible a note says so, and the mouth opens to the
/// patient's default maximum or, if that is impossible too, along the motion.
Motion opening_of(const MotionChoice& choice, const Motion& motion, const Scene& scene,
                  SessionSettings options, std::vector<std::string>& notes) {
  if (choice.spec == "opening" || motion.recording) return motion;
  MotionChoice opening{.spec = "opening", .parameters = choice.parameters, .excitations = {}};
  for (const bool asked : {true, false}) {
    if (!asked) {
      const bool was_asked = opening.parameters.erase("opening") > 0 ||
                             options.motion.parameters.opening_mm.has_value();
      options.motion.parameters.opening_mm.reset();
      if (!was_asked) break;
    }
    try {
      return make(opening, scene, options);
    } catch (const InputError& error) {
      notes.push_back(fmt::format("the opening slider cannot open as requested: {}", error.what()));
    }
  }
  return motion;
}

}  // namespace

std::vector<std::string> motion_names(const Scene& scene) {
  std::vector<std::string> names = builtin_motions();
  if (std::find(names.begin(), names.end(), "opening") == names.end())
    names.insert(names.begin(), "opening");
  names.emplace_back(by_hand);
  if (scene.plan)
    for (const Seat& seat : scene.plan->seats) names.push_back("path:" + seat.name);
  return names;
}

SessionMotion make_session_motion(const MotionChoice& choice, const SessionPatient& patient,
                                  const SessionSettings& options) {
  const Case& of = patient.scene.patient;
  SessionMotion made{.choice = choice,
                     .motion = make(choice, patient.scene, options),
                     .opening = {},
                     .widest_mm = 0,
                     .settings = {},
                     .excitations = {}};
  const Motion& motion = made.motion;
  made.opening = opening_of(choice, motion, patient.scene, options, made.motion.notes);
  constexpr int samples = 200;
  for (int i = 0; i <= samples; ++i) {
    const Pose X_CM = made.opening.target(made.opening.duration_s * i / samples);
    made.widest_mm = std::max(made.widest_mm, measure(of, with_jaw_at(of.bodies, X_CM)).opening_mm);
  }
  made.settings = motion_settings(choice, motion, of.motion, made.widest_mm);
  if (!motion.muscles) return made;
  const bool free = choice.spec == by_hand;
  for (const auto& group : muscle_groups())
    made.excitations.push_back(
        {group.name, group.label, free ? 1.0 : 2.0,
         excitation_of(choice, group.name, free ? group.default_excitation : 1)});
  return made;
}

std::map<std::string, double> excitations_at(const SessionMotion& motion, double time_s) {
  std::map<std::string, double> excitations;
  if (!motion.motion.muscles) return excitations;
  const MuscleStates states =
      motion.motion.muscles(motion.choice.spec == by_hand ? held_at_s() : time_s);
  for (std::size_t m = 0; m < std::min(states.size(), motion.motion.muscle_names.size()); ++m)
    excitations[motion.motion.muscle_names[m]] = states[m].excitation;
  return excitations;
}

Pose rest_position(const MotionChoice& choice, const SessionPatient& patient,
                   const SessionSettings& options) {
  const Motion rest = make({.spec = "rest", .parameters = choice.parameters, .excitations = {}},
                           patient.scene, options);
  return rest.target(rest.duration_s);
}

}  // namespace condyle
