#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/dynamics/muscle_motion.h"
#include "sim/plan/plan.h"
#include "sim/simulator/simulator.h"
#include "tools/command.h"
#include "tools/tissue_options.h"

namespace condyle {

/// Patient and motion.
struct MotionOptions {
  std::filesystem::path patient = {};  // case folder; empty: the built-in patient
  std::filesystem::path plan = {};     // of an operation before the motion; empty: none
  std::string motion = {};
  std::string expression = {};             // of the face; empty: none
  std::vector<std::string> weakness = {};  // of the face's muscles, unparsed
  MotionSettings settings = {};
  MuscleMotionSettings muscles = {};
  bool respect_contact = false;  // a recorded motion also slides where bones meet
  double friction = 0;
  std::vector<std::string> pairs = {};  // rules, unparsed
  TissueOptions tissue = {};
};

// Each adds options to a command and binds them to the values, which must outlive it.

/// Case and motion, in the group "Basics".
void add_motion(CLI::App& command, MotionOptions& motion);
/// --expression and --weakness, and a --motion that may then be left out.
void add_expression(CLI::App& command, MotionOptions& motion);
/// Rules of pairs of parts, in the group "Contact".
void add_pairs(CLI::App& command, MotionOptions& motion);
/// Response of a motion to contact, in the group "Contact".
void add_sliding(CLI::App& command, MotionOptions& motion);
/// The parameters of the motion in the group "Motion", and the group "Muscles".
void add_motion_details(CLI::App& command, MotionOptions& motion);

SimulatorSettings simulator_settings(const MotionOptions& options, const CommonOptions& common);

/// Checks words, files and numbers that need no patient. throws: InputError.
void check_motion(const MotionOptions& options);
/// Checks the options for this patient, before any model of it is built. throws: InputError.
void check_motion(const MotionOptions& options, const Case& patient);

/// --plan: the plan of an operation that the patient has undergone.
void add_plan_file(CLI::App& command, std::filesystem::path& plan);
/// The plan in a file; none if the path is empty. throws: InputError.
std::optional<Plan> plan_of(const std::filesystem::path& file);
/// The case that is given, or else the built-in head that the plan was made for.
std::filesystem::path case_of(const MotionOptions& options);

/// The scene of the patient, after the operation if there is a plan.
Scene scene_of(const MotionOptions& options, Case patient, const SimulatorSettings& settings,
               const Progress& progress);

/// The motion of the command line.
Motion motion_of(const MotionOptions& options, const Scene& scene, int threads);

}  // namespace condyle
