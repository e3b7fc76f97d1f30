#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/contact/contact.h"

namespace condyle {

/// Asks for a pose of the mandible at each time.
struct Motion {
  std::string name;
  double duration_s = 0;
  bool recorded = false;  // a recording is played back as it is unless contact is asked for
  std::function<Pose(double time_s)> wanted;  // X_CM; clamps the time to [0, duration_s]
  std::vector<std::string> notes;             // how it was made, for people
  std::vector<double> sample_times = {};      // of a recording, increasing from 0 to duration_s
};

struct OpeningSettings {
  double opening_mm =
      0;  // drop of the incisal point wanted at full opening; 0 = the patient's default
  double duration_s = 3.0;        // opening and closing
  double early_translation = -1;  // 0 pure hinge first, 1 translation from the start; < 0 = as
                                  // early as the joint requires
};

/// Names of the built-in motions.
const std::vector<std::string>& builtin_motions();

/// The motion called `spec`: a built-in name or a pose file (CSV). `contacts`, of the same patient,
/// tells how far the bones let the jaw go.
/// throws: InputError for an unknown name (listing the known ones), bad settings or a bad file.
Motion make_motion(const std::string& spec, const Case& patient, const ContactModel& contacts,
                   const OpeningSettings& settings = {});

}  // namespace condyle
