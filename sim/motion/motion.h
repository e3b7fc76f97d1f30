#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/contact/contact.h"
#include "sim/frame/face_excitation.h"
#include "sim/frame/muscle_state.h"

namespace condyle {

/// A named interval of a motion.
struct MotionPhase {
  std::string name;  // as in "opening", "chewing right"
  double start_s = 0, end_s = 0;
};

/// A parameter that a motion was generated from; finding its value in the results is no evidence.
struct MotionInput {
  std::string name, unit;
  double value = 0;
};

/// Border movements of the lower incisal point, mm, in the cranium's frame.
struct MotionBorders {
  std::vector<Eigen::Vector3d> sagittal, frontal;  // closed curves
};

/// Facts about the file of a recorded motion.
struct RecordingFacts {
  std::string format;
  int rows = 0, rows_without_pose = 0;
  double median_step_s = 0;
  struct Gap {
    double after_s = 0, length_s = 0;
  };
  std::vector<Gap> gaps = {};  // longer than 2.5 median steps
  bool has_markers = false;
  double residual_rms_mm = 0, residual_max_mm = 0;  // of markers to the fitted rigid pose
  double smooth_hz = 0;                             // cutoff of the low-pass filter; 0: unfiltered
  std::string file_name;
  double largest_shift_mm = 0;  // of the translations as given in the file
};

/// Prescribes a pose of the mandible at each time.
struct Motion {
  std::string name;
  double duration_s = 0;
  bool recorded = false;  // a recording is played back unchanged unless contact is requested
  std::function<Pose(double time_s)> target;  // X_CM; clamps the time to [0, duration_s]
  std::vector<std::string> notes = {};        // how it was generated, as sentences
  std::vector<double> sample_times = {};      // of a recording, increasing from 0 to duration_s

  std::vector<MotionPhase> phases = {};  // of a built-in motion, in order
  std::vector<MotionInput> inputs = {};
  std::vector<MotionInput> found = {};  // values determined by the patient's joints
  MotionBorders borders = {};           // of motions that are compared with them (chewing, posselt)
  // Of a muscle-driven motion: names and states of the muscles at a time.
  std::vector<std::string> muscle_names = {};
  std::function<MuscleStates(double time_s)> muscles = {};
  // Of the face at a time; empty: it is relaxed.
  std::function<FaceExcitation(double time_s)> expression = {};
  LidStrength lid_strength = {};  // of blinks that are no part of the motion
  // X_CH at a time, rest to now, where muscles attach to a hyoid; empty: it is fixed.
  std::function<Pose(double time_s)> hyoid = {};
  std::optional<RecordingFacts> recording = {};  // of a file
  // X_PB at a time, where the motion moves bodies besides the jaw; empty: they stay.
  std::function<std::vector<Pose>(double time_s)> pieces = {};
};

struct MotionSettings {
  MotionParameters parameters = {};  // take precedence over those of the case
  double duration_s = 0;             // of the whole motion; 0: its natural duration
  // Reported while the opening that the bones permit is searched; an exception cancels.
  Progress progress = {};
};

/// Names of the built-in motions.
const std::vector<std::string>& builtin_motions();

/// Whether expressions in its words move brows or forehead, see TissueSettings::upper_face; also of
/// a motion that muscles follow (inverse:MOTION). false for what is no motion in words. throws:
/// InputError as make_motion() for wrong words.
bool motion_moves_upper_face(const std::string& name);
/// Whether expressions or blinks in its words move lids; as motion_moves_upper_face().
bool motion_moves_lids(const std::string& name);

/// Checks what can be wrong with a motion without a patient: its name, words, file and settings.
/// throws: InputError as make_motion().
void check_motion(const std::string& spec, const MotionSettings& settings = {});

/// The motion called `spec`: a built-in name, a motion script ("open 40; close; smile 0.8"), a
/// script file (*.motion), or a pose file (CSV). `contacts`, of the same patient, limits the motion
/// to what the bones permit.
/// throws: InputError for an unknown name (listing the valid ones), invalid settings or a bad file.
Motion make_motion(const std::string& spec, const Case& patient, const ContactModel& contacts,
                   const MotionSettings& settings = {});

}  // namespace condyle
