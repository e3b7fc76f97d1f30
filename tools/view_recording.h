#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

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
};

/// Records the motion as the window shows it: its parts, overlays, colours, wipe, scale and
/// letters; bones stay where hands have put them, and slide on contact if it is obeyed. gives: what
/// was made, as a sentence. throws: MachineError.
std::string record_view(const ViewRecording& subject, const SimulatorSettings& settings,
                        const Progress& progress);

}  // namespace condyle
