#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/choice/motion_choice.h"
#include "sim/session/session_patient.h"
#include "sim/session/session_settings.h"

namespace condyle {

/// A motion of a session's patient.
struct SessionMotion {
  MotionChoice choice;
  Motion motion;
  Motion opening;        // along which a hand opens the mouth
  double widest_mm = 0;  // of the opening
  std::vector<MotionSetting> settings;
  std::vector<ExcitationSetting> excitations;
};

/// Names to choose from; "by-muscles" is a motion whose muscles are excited by hand, "path:NAME"
/// the insertion path of a graft.
std::vector<std::string> motion_names(const Scene& scene);

/// Makes the motion that was chosen. throws: InputError.
SessionMotion make_session_motion(const MotionChoice& choice, const SessionPatient& patient,
                                  const SessionSettings& settings);

/// Excitations by muscle of a muscle-driven motion at a time, or the levels set by hand; none for
/// another motion.
std::map<std::string, double> excitations_at(const SessionMotion& motion, double time_s);

/// The rest position of the mandible with the parameters that were chosen. throws: InputError.
Pose rest_position(const MotionChoice& choice, const SessionPatient& patient,
                   const SessionSettings& settings);

}  // namespace condyle
