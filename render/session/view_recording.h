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

/// What a window recorded from shows when the recording begins.
struct ViewRecording {
  request::Record record;
  ViewState view;
  std::vector<MovableBody> bodies;
  std::optional<Pose> held_jaw;  // where a hand or the slider wants it; none: as the motion does
  std::shared_ptr<const SessionPatient> patient;
  std::shared_ptr<const SessionMotion> motion;
  std::shared_ptr<const LineSet> paths;
};

/// What is done where the recording's folder holds pictures already.
enum class Existing { ask, resume, replace };

/// What came of a recording.
struct ViewRecorded {
  enum class End { made, stopped, failed, asks };
  End end = End::made;
  std::string words;     // a sentence; of one that asks: what is in the folder
  RecordingThere there;  // unless it was made
};

/// Records the motion as the window shows it: its parts, overlays, colours, wipe, scale and
/// letters; bones stay where hands have put them, and slide on contact if it is obeyed. throws:
/// InputError for wrong choices; the result reports what fails later.
ViewRecorded record_view(const ViewRecording& subject, Existing existing,
                         const SimulatorSettings& settings, const Progress& progress);

}  // namespace condyle
