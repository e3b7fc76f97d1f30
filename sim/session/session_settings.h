#pragma once

#include <string>

#include "sim/dynamics/muscle_motion.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// What a session begins with, as values: a front end has parsed them.
struct SessionSettings {
  std::string first_motion = "opening";  // of the first patient; a name, a file or movements
  MotionSettings motion = {};            // of every motion, before what is chosen for one
  MuscleMotionSettings muscles = {};
  bool respect_contact = false;  // recorded motion, too, slides where bones meet
  SimulatorSettings simulator = {};
};

}  // namespace condyle
