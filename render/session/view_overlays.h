#pragma once

#include <memory>

#include "render/scene/shown_overlays.h"
#include "render/window/view/view_state.h"
#include "sim/frame/frame_state.h"
#include "sim/session/session_motion.h"
#include "sim/session/session_patient.h"

namespace condyle {

/// What stands beside the parts in a view, of one frame: axes, paths of the motion, what the tissue
/// is made of, lines of action of muscles. `paths`: where incisor and condyles go; none: not known
/// yet.
Overlays view_overlays(const SessionPatient& patient, const Motion& motion, const FrameState& frame,
                       const ViewState& view, const std::shared_ptr<const LineSet>& paths);

/// The part of a view that the overlays follow from: the same while nothing of it changes.
struct OverlayInputs {
  bool springs = false, prisms = false, bone_springs = false, axes = false, paths = false;
  std::vector<PartView> muscles = {}, layers = {};
  std::shared_ptr<const LineSet> known_paths = {};
  bool operator==(const OverlayInputs&) const = default;

  static OverlayInputs of(const ViewState& view, std::shared_ptr<const LineSet> paths) {
    const Look& look = view.look;
    return {look.springs, look.prisms,  look.bone_springs, look.axes,
            look.paths,   view.muscles, view.layers,       std::move(paths)};
  }
};

/// What a tree lists of a patient's muscles, and of the layers of the soft tissue.
std::vector<TreeItem> muscle_items(const SessionPatient& patient);
std::vector<TreeItem> layer_items(const SessionPatient& patient);

}  // namespace condyle
