#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "render/recording/muscle_bellies.h"
#include "render/scene/shown_overlays.h"
#include "render/window/view/view_state.h"
#include "sim/frame/frame_state.h"
#include "sim/session/session_motion.h"
#include "sim/session/session_patient.h"

namespace condyle {

bool shows_muscles(const ViewState& view);

/// Overlays of a view at one frame: axes, paths of the motion, elements of the tissue, muscles,
/// the mirror image of a part. `paths`: of incisor and condyles; none: not known yet. `bellies`: of
/// its muscles; null: none are drawn.
Overlays view_overlays(const SessionPatient& patient, const Motion& motion, const FrameState& frame,
                       const ViewState& view, const std::shared_ptr<const LineSet>& paths,
                       const MuscleBellies* bellies);

/// The settings of a view that determine the overlays; equal while none of them changes.
struct OverlayInputs {
  bool springs = false, prisms = false, bone_springs = false, axes = false, paths = false;
  bool facial_muscles = false, muscle_labels = false;
  std::vector<PartView> muscles = {}, layers = {};
  std::string mirrored = {};
  std::shared_ptr<const LineSet> known_paths = {};
  std::shared_ptr<const MuscleBellies> bellies = {};
  bool operator==(const OverlayInputs&) const = default;

  static OverlayInputs of(const ViewState& view, std::shared_ptr<const LineSet> paths,
                          std::shared_ptr<const MuscleBellies> bellies = {}) {
    const Look& look = view.look;
    return {look.springs, look.prisms,         look.bone_springs,  look.axes,
            look.paths,   look.facial_muscles, look.muscle_labels, view.muscles,
            view.layers,  look.mirrored,       std::move(paths),   std::move(bellies)};
  }
};

/// The midsagittal plane of the plan's landmarks, in the cranium's frame; none where they are
/// missing.
std::optional<Eigen::Hyperplane<double, 3>> midsagittal_plane(const SessionPatient& patient);

/// The expressions and action units for a patient's face; none without its muscles.
std::vector<TreeItem> expression_items(const SessionPatient& patient);

/// Entries of the tree for a patient's muscles, and for the layers of the soft tissue.
std::vector<TreeItem> muscle_items(const SessionPatient& patient);
std::vector<TreeItem> layer_items(const SessionPatient& patient);

}  // namespace condyle
