#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/core/progress.h"
#include "render/overlay/overlays.h"
#include "render/scene/shown_overlays.h"
#include "sim/case/case.h"
#include "sim/case/muscle.h"
#include "sim/frame/frame_state.h"
#include "sim/motion/motion.h"

namespace condyle {

/// Bellies of a patient's jaw muscles for pictures: straps or spindles whose cross-section follows
/// from the strength, bent around the bones at rest. The simulation has straight lines of action.
class MuscleBellies {
 public:
  /// Shapes all of them at rest; some tenths of a second.
  MuscleBellies(std::vector<Muscle> muscles, const Case& patient, const Progress& progress = {});

  const std::vector<Muscle>& muscles() const { return muscles_; }

  /// A muscle at the present poses: carried by its bones, of constant volume, pale at its tendons,
  /// brighter when excited. The hyoid follows the motion.
  FibreBody body(std::size_t muscle, const Motion& motion, const FrameState& frame,
                 double opacity = 1) const;
  /// Its name at the middle of its belly in such a body.
  PlaceLabel label(std::size_t muscle, const FibreBody& body) const;

 private:
  /// At rest, in the cranium's frame, mm: rings from origin to insertion, then a point at each end.
  struct Belly {
    std::vector<Eigen::Vector3d> rest = {};
    std::vector<float> fibres = {};
    std::vector<Eigen::Vector3i> triangles = {};
  };
  std::vector<Muscle> muscles_;
  std::vector<Belly> bellies_;
};

/// Adds bodies of a patient's muscles, their key and, if asked for, their names. `opacity`: of
/// each, 0 where it is hidden; empty: all are opaque.
void add_muscles(const MuscleBellies& bellies, const Motion& motion, const FrameState& frame,
                 std::span<const double> opacity, bool labels, Overlays& shown);

}  // namespace condyle
