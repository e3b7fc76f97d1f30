#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/contact/contact.h"
#include "sim/frame/muscle_state.h"

namespace condyle {

/// A named stretch of a motion.
struct MotionPhase {
  std::string name;  // as in "opening", "chewing right"
  double start_s = 0, end_s = 0;
};

/// What a motion was made from: it proves nothing when it is found again.
struct MotionInput {
  std::string name, unit;
  double value = 0;
};

/// Border movements of the lower incisal point, mm, in the cranium's frame.
struct MotionBorders {
  std::vector<Eigen::Vector3d> sagittal, frontal;  // closed rounds
};

/// What is known of a recorded motion's file.
struct RecordingFacts {
  std::string format;
  int rows = 0, rows_without_pose = 0;
  double usual_step_s = 0;
  struct Gap {
    double after_s = 0, length_s = 0;
  };
  std::vector<Gap> gaps = {};  // longer than two and a half usual steps
  bool has_markers = false;
  double residual_rms_mm = 0, residual_max_mm = 0;  // of markers from the fitted rigid pose
  double smooth_hz = 0;                             // jitter above was taken out; 0: nothing was
  std::string file_name;
  double largest_shift_mm = 0;  // of the translations as they stand in the file
};

/// Asks for a pose of the mandible at each time.
struct Motion {
  std::string name;
  double duration_s = 0;
  bool recorded = false;  // a recording is played back as it is unless contact is asked for
  std::function<Pose(double time_s)> wanted;  // X_CM; clamps the time to [0, duration_s]
  std::vector<std::string> notes;             // how it was made, for people
  std::vector<double> sample_times = {};      // of a recording, increasing from 0 to duration_s

  std::vector<MotionPhase> phases = {};  // of a built-in motion, in order
  std::vector<MotionInput> inputs = {};
  std::vector<MotionInput> found = {};  // what nobody gave: as the patient's joints have it
  MotionBorders borders = {};  // of motions that are measured by them (chewing, posselt)
  // Of a motion driven by muscles: their names, and what each does at a time.
  std::vector<std::string> muscle_names = {};
  std::function<MuscleStates(double time_s)> muscles = {};
  // X_CH at a time, rest to now, where muscles hang from a hyoid; none: it stays.
  std::function<Pose(double time_s)> hyoid = {};
  std::optional<RecordingFacts> recording = {};  // of a file
};

struct MotionSettings {
  MotionParameters parameters = {};  // before those of the case
  double duration_s = 0;             // of the whole motion; 0 = its own time
};

/// Names of the built-in motions.
const std::vector<std::string>& builtin_motions();

/// The motion called `spec`: a built-in name, movements in words ("open 40; close; protrude 6"), a
/// file of such words (*.motion), or a pose file (CSV). `contacts`, of the same patient, tells how
/// far the bones let the jaw go.
/// throws: InputError for an unknown name (listing the known ones), bad settings or a bad file.
Motion make_motion(const std::string& spec, const Case& patient, const ContactModel& contacts,
                   const MotionSettings& settings = {});

}  // namespace condyle
