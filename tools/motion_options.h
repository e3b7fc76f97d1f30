#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/dynamics/muscle_motion.h"
#include "sim/simulator/simulator.h"
#include "tools/command.h"
#include "tools/tissue_options.h"

namespace condyle {

/// Who moves, and how.
struct MotionOptions {
  std::filesystem::path patient = {};  // case folder; empty: the built-in patient
  std::string motion = {};
  MotionSettings settings = {};
  MuscleMotionSettings muscles = {};
  bool respect_contact = false;  // a recorded motion, too, slides where bones meet
  double friction = 0;
  std::vector<std::string> pairs = {};  // rules as the user wrote them
  TissueOptions tissue = {};
};

// Each adds options to a command and lets them write into the values, which must outlive it.

/// Case and motion, in the group "Basics".
void add_motion(CLI::App& command, MotionOptions& motion);
/// Rules of pairs of parts, in the group "Contact".
void add_pairs(CLI::App& command, MotionOptions& motion);
/// How contact bends a motion, in the group "Contact".
void add_sliding(CLI::App& command, MotionOptions& motion);
/// The parameters of the motion in the group "Motion", and the group "Muscles".
void add_motion_details(CLI::App& command, MotionOptions& motion);

SimulatorSettings simulator_settings(const MotionOptions& options, const CommonOptions& common);

/// What needs no patient to be wrong: words, files and numbers. throws: InputError.
void check_motion(const MotionOptions& options);
/// What is wrong for this patient, before any model of it is built. throws: InputError.
void check_motion(const MotionOptions& options, const Case& patient);

/// The motion that the command line asks for.
Motion motion_of(const MotionOptions& options, const Scene& scene, int threads);

}  // namespace condyle
