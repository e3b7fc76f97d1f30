#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/choice/motion_choice.h"
#include "sim/motion/motion.h"

namespace condyle {

/// Muscles that are excited together: their name in a file of excitations, and their description.
struct MuscleGroup {
  const char* name;
  const char* label;
  std::vector<const char*> muscles;
  double default_excitation;  // 0 to 1, of a motion whose muscles are excited by hand
};
const std::vector<MuscleGroup>& muscle_groups();

/// The excitation that a choice gives to a group, or `otherwise` when it gives none.
double excitation_of(const MotionChoice& choice, const std::string& group, double otherwise);

/// A file of excitations in which every group rises, holds its level and falls.
std::string held_excitations(const MotionChoice& choice);

/// A time, s, at which all groups of `held_excitations` are at their level.
double held_at_s();

/// A file of the excitations of a motion driven by muscles, each times the fraction that the choice
/// gives to its group.
std::string scaled_excitations(const Motion& base, const MotionChoice& choice);

}  // namespace condyle
