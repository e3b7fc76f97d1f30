#pragma once

#include <filesystem>
#include <memory>

#include "engine/core/progress.h"
#include "render/window/wishes.h"
#include "tools/view_motion.h"

namespace condyle {

/// Records a motion as the window shows it, off the screen, in full quality; pictures are packed
/// and written beside the drawing. gives: the film, or the folder of the pictures.
/// throws: MachineError when the disk is full or ffmpeg is missing; what was recorded there before
/// comes back.
std::filesystem::path record_view(const wish::Record& wanted, const ViewPatient& patient,
                                  const Motion& motion, const SimulatorSettings& settings,
                                  bool obey_contact, const Progress& progress);

}  // namespace condyle
