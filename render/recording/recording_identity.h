#pragma once

#include <span>

#include "render/output/recording_sheet.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Data that determines the frames of a recording: case, motion (at its fixed steps and at the
/// times of the frames), contact and tissue.
RecordingSheet recording_identity(const Scene& scene, const Motion& motion,
                                  std::span<const double> times_s,
                                  const SimulatorSettings& settings, bool respect_contact);

}  // namespace condyle
