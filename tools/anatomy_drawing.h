#pragma once

#include <string>

#include "render/overlay_key.h"
#include "render/overlays.h"
#include "sim/case/muscle.h"
#include "sim/frame/frame_state.h"
#include "sim/motion/motion.h"
#include "sim/tissue/tissue.h"

namespace condyle {

/// A muscle's line of action where its bones are: dark red at rest, bright yellow when fully
/// excited. The hyoid is where the motion has it.
LineSet muscle_line(const Muscle& muscle, const Motion& motion, const FrameState& frame,
                    double opacity = 1);

/// The sheet below so many layers of soft tissue, where its nodes are now.
GlassSheet layer_sheet(const TissueModel& model, const TissueState& now, int sheet,
                       double opacity = 0.5);
/// What their colours mean.
KeyEntry muscle_key();
KeyEntry layer_key(const TissueModel& model, int sheet);
/// "Fat", where there are the usual three; "Fat, 2 of 2" where a fine net has cut it.
std::string layer_label(const TissueModel& model, int sheet);
/// For a narrow list.
std::string layer_short_label(const TissueModel& model, int sheet);
/// Of an overlay: in the order of their names inner sheets come first, outer ones lie over them.
std::string layer_overlay_name(int sheet);

}  // namespace condyle
