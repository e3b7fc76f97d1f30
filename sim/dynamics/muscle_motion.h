#pragma once

#include <filesystem>
#include <string>

#include "sim/dynamics/excitation_finder.h"
#include "sim/dynamics/muscle_jaw.h"
#include "sim/motion/motion.h"

namespace condyle {

struct MuscleMotionSettings {
  MuscleLawSettings law = {};
  BolusSettings bolus = {};
  std::string hyoid =
      "fixed";        // free, fixed, or a CSV of its displacement from rest: time_s,x_mm,y_mm,z_mm
  bool teeth = true;  // false: a flat bite at the back teeth
  ExcitationFinderSettings finder = {};
};

/// Settings of the muscle-driven jaw. throws: InputError for an invalid hyoid file.
MuscleJawSettings jaw_settings(const MuscleMotionSettings& settings);

/// Motion of the mandible under the excitations of a file (sim/muscles/excitations.h), simulated
/// once from rest. throws: InputError for invalid files, or where the excitations make the
/// simulation diverge.
Motion muscles_from_file(const std::filesystem::path& file, const Case& patient,
                         const MuscleMotionSettings& settings, int threads = 1);

/// Motion of the mandible under muscles excited so that it tracks a given motion.
Motion muscles_that_follow(const Motion& reference, const Case& patient,
                           const MuscleMotionSettings& settings, int threads = 1);

/// The motion called `spec`: "muscles:FILE", "inverse:MOTION" (muscles that follow a motion of
/// make_motion), or a motion of make_motion.
Motion motion_of(const std::string& spec, const Case& patient, const ContactModel& contacts,
                 const MotionSettings& opening = {}, const MuscleMotionSettings& muscles = {},
                 int threads = 1);

/// Checks of such a motion what needs no patient: names, words, files and settings.
/// throws: InputError as motion_of().
void check_motion(const std::string& spec, const MotionSettings& settings,
                  const MuscleMotionSettings& muscles);
/// Checks its excitations for the patient's muscles. throws: InputError as motion_of().
void check_excitations(const std::string& spec, const Case& patient);

/// The excitations of a motion's muscles as a file that muscles_from_file reads.
std::string excitations_csv(const Motion& motion);

}  // namespace condyle
