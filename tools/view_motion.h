#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/overlays.h"
#include "render/window/plot_set.h"
#include "sim/dynamics/muscle_motion.h"
#include "tools/commands.h"
#include "tools/view_patient.h"

namespace condyle {

/// A motion of a patient as the window has it.
struct ViewMotion {
  MotionChoice choice;
  Motion motion;
  Motion opening;        // what a hand opens the mouth along
  double widest_mm = 0;  // of it
  std::vector<MotionSetting> settings;
  std::vector<ExcitationSetting> excitations;
};

/// Names to choose from; "by-muscles" is a motion whose muscles are excited by hand.
std::vector<std::string> motion_names();

/// Makes the motion that was chosen. throws: InputError.
ViewMotion make_view_motion(const MotionChoice& choice, const ViewPatient& patient,
                            const MotionOptions& options, int threads);

/// Excitations by muscle that a motion by muscles has at a time, or holds where they are set by
/// hand; none for another motion.
std::map<std::string, double> excitations_at(const ViewMotion& motion, double time_s);

/// The rest position of the mandible with the parameters that were chosen. throws: InputError.
Pose rest_position(const MotionChoice& choice, const ViewPatient& patient,
                   const MotionOptions& options, int threads);

/// What is plotted of a motion, and where the incisal point and the condyles go in space.
struct MotionPictures {
  std::vector<PlotSet> plots;
  LineSet paths;
};

/// Walks through the whole motion with contact but without soft tissue. `partly` is told now and
/// then what there is so far.
MotionPictures motion_pictures(const ViewPatient& patient, const Motion& motion,
                               SimulatorSettings settings, bool obey_contact,
                               const std::function<void(MotionPictures)>& partly,
                               const Progress& progress);

}  // namespace condyle
