#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/export/slicer_files.h"
#include "sim/operation/operation.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// A part as it lies in a frame. LPS, mm.
struct PosedSurface {
  std::string name;
  TriMesh mesh;
};

/// All parts of the scene in a frame: rigid ones with their bodies, the face as the tissue carries
/// it where the frame has it.
std::vector<PosedSurface> posed_surfaces(const Scene& scene, const FrameState& frame);

/// The landmarks in a frame: those of bones and teeth with their bodies, those within 6 mm of the
/// face with its nearest point. Others stay.
Landmarks posed_landmarks(const Scene& scene, const FrameState& frame);

/// A body and its displacement from the case, before any operation, to a frame.
struct MovedBody {
  std::string name;
  Pose X;
};

/// The bodies that moved. `operated`: of the scene's plan, or null for a patient without one.
std::vector<MovedBody> moved_bodies(const Scene& scene, const FrameState& frame,
                                    const Operated* operated);

/// Measures as lines and angles: between the incisal points, descent of the lower one, SNA and SNB
/// on the midsagittal plane; after an operation the displacement of each landmark of the planner's
/// table (`uncut`: the case before it). What has no landmarks is left out.
std::vector<SlicerMarkup> measure_markups(const Scene& scene, const FrameState& frame,
                                          const Operated* operated);

}  // namespace condyle
