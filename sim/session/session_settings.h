#pragma once

#include <filesystem>
#include <string>

#include "sim/dynamics/muscle_motion.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Initial settings of a session, already parsed by the front end.
struct SessionSettings {
  std::string first_motion = "opening";  // of the first patient; a name, a file or movements
  MotionSettings motion = {};            // of every motion; choices for one override them
  MuscleMotionSettings muscles = {};
  std::filesystem::path plan = {};  // file of the first patient's operation; empty: none
  bool respect_contact = false;     // recorded motion also slides where bones meet
  // Whether drafts of plans, autosaved sessions and the list of recent files are kept in the user's
  // folders.
  bool keeps_files = true;
  SimulatorSettings simulator = {};
};

}  // namespace condyle
