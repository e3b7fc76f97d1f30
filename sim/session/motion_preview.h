#pragma once

#include <array>
#include <functional>
#include <vector>

#include "engine/core/progress.h"
#include "sim/frame/plot_set.h"
#include "sim/session/session_patient.h"

namespace condyle {

/// Preview of a whole motion without soft tissue: plots over time, and the paths of three points of
/// the mandible in the cranium's frame.
struct MotionPreview {
  std::vector<PlotSet> plots;
  std::array<std::vector<Eigen::Vector3f>, 3> paths;  // incisal point, left and right condyle
};

/// Plays the whole motion with contact but without soft tissue. `partly` receives the
/// intermediate result a few times a second.
MotionPreview preview_motion(const SessionPatient& patient, const Motion& motion,
                             SimulatorSettings settings, bool obey_contact,
                             const std::function<void(MotionPreview)>& partly,
                             const Progress& progress);

}  // namespace condyle
