#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/output/recorder.h"
#include "render/overlay/overlays.h"
#include "render/window/view/view_state.h"
#include "sim/session/session_motion.h"
#include "sim/session/session_patient.h"

namespace condyle {

/// State of the window when the recording begins.
struct ViewRecording {
  request::Record record;
  ViewState view;
  std::vector<MovableBody> bodies;
  std::optional<Pose> held_jaw;  // target set by a hand or the slider; none: the motion's
  std::shared_ptr<const SessionPatient> patient;
  std::shared_ptr<const SessionMotion> motion;
  std::shared_ptr<const LineSet> paths;
};

/// Action if the recording's folder contains pictures already.
enum class Existing { ask, resume, replace };

/// Result of a recording.
struct ViewRecorded {
  enum class End { made, stopped, failed, asks };
  End end = End::made;
  std::string words;     // a sentence; if the user is asked: the content of the folder
  RecordingThere there;  // unless it is complete
};

/// Records the motion as the window shows it: its parts, overlays, colours, wipe, scale and
/// letters. Bones moved by hand keep their poses, and slide on contact if it is obeyed. throws:
/// InputError for invalid choices; the result reports later failures.
ViewRecorded record_view(const ViewRecording& subject, Existing existing,
                         const SimulatorSettings& settings, const Progress& progress);

}  // namespace condyle
