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
  std::string hyoid = "fixed";  // free, fixed, or a CSV of its way: time_s,x_mm,y_mm,z_mm from rest
  bool teeth = true;            // false: a flat bite at the back teeth
  ExcitationFinderSettings finder = {};
};

/// Of the jaw that such muscles pull. throws: InputError for a bad file of the hyoid's way.
MuscleJawSettings jaw_settings(const MuscleMotionSettings& settings);

/// The mandible pulled by muscles that are excited as a file tells (sim/muscles/excitations.h):
/// simulated whole, once, from rest. throws: InputError for bad files, or where the excitations
/// tear the jaw off.
Motion muscles_from_file(const std::filesystem::path& file, const Case& patient,
                         const MuscleMotionSettings& settings, int threads = 1);

/// The mandible pulled by muscles so that it follows a wanted motion as well as they can.
Motion muscles_that_follow(const Motion& wanted, const Case& patient,
                           const MuscleMotionSettings& settings, int threads = 1);

/// The motion called `spec`: "muscles:FILE", "inverse:MOTION" (muscles that follow a motion of
/// make_motion), or a motion of make_motion.
Motion motion_of(const std::string& spec, const Case& patient, const ContactModel& contacts,
                 const MotionSettings& opening = {}, const MuscleMotionSettings& muscles = {},
                 int threads = 1);

/// What the muscles of a motion were excited by, as a file that muscles_from_file reads.
std::string excitations_csv(const Motion& motion);

}  // namespace condyle
