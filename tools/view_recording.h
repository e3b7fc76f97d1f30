#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/recorder.h"
#include "tools/view_motion.h"
#include "tools/view_patient.h"

namespace condyle {

/// What a window recorded from shows when the recording begins.
struct ViewRecording {
  wish::Record wanted;
  ViewState view;
  std::vector<MovableBody> bodies;
  std::optional<Pose> held_jaw;  // where a hand or the slider wants it; none: as the motion does
  std::shared_ptr<const ViewPatient> patient;
  std::shared_ptr<const ViewMotion> motion;
  std::shared_ptr<const LineSet> paths;
  MotionOptions options;  // of the command line
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
/// InputError for wrong choices; what fails later is told by the result.
ViewRecorded record_view(const ViewRecording& subject, Existing existing,
                         const SimulatorSettings& settings, const Progress& progress);

}  // namespace condyle
