#pragma once

#include <span>

#include "render/recording_sheet.h"
#include "sim/simulator/simulator.h"
#include "tools/commands.h"

namespace condyle {

/// What decides the frames of a recording: case, motion (at its fixed steps and at the frames'
/// times), contact and tissue.
RecordingSheet recording_identity(const Scene& scene, const Motion& motion,
                                  std::span<const double> times_s, double step_s,
                                  const MotionOptions& options);

}  // namespace condyle
