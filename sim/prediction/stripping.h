#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/operation/operation.h"
#include "sim/plan/plan.h"
#include "sim/tissue/pieces.h"
#include "sim/tissue/tissue.h"

namespace condyle {

/// How far a surgeon lifts the soft tissue off the bone, and what remains of its attachment.
/// Fitted on the built-in patient to the published ratios of soft to hard tissue.
struct StrippingSettings {
  double reach_mm = 8;        // from a cut line along the bone
  double near_cut = 0.05;     // fraction of the attachment's stiffness that remains there
  double on_maxilla = 0.05;   // the same on the whole front of a Le Fort I segment
  double freed_mm = 20;       // from the cut of a genioplasty up to the vestibular incision
  double above_chin = 0.001;  // the fraction that remains there
  double on_chin = 0.25;      // the fraction that remains on the chin segment, where it is degloved
  double septum = 0.4;        // of the nose over a Le Fort I segment that the septum holds back
  double resected = 0.001;    // the fraction that remains where the bone was resected
};

/// Attachments that were stripped.
struct Stripping {
  StrippingSettings settings;
  std::vector<double> kept;  // of each anchor of the tissue: fraction of its stiffness
  int attachments = 0;       // to bone, before
  // Number of those stripped near cut lines, on Le Fort I segments, above and on chins.
  int near_cuts = 0, on_maxilla = 0, above_chin = 0, on_chin = 0;
  int resected = 0;  // of those whose bone was removed

  int stripped() const { return near_cuts + on_maxilla + above_chin + on_chin + resected; }
};

/// The attachments that the cuts of a plan strip, moved or not: all of resected bone; near a cut
/// line or a trimmed face those of both sides; of a Le Fort I segment the whole front; of a
/// genioplasty the front of the jaw above it, and in part the chin, whose lower border keeps its
/// periosteum. `cuts`: of the patient of `tissue`, see operated_tissue().
Stripping strip(const TissueModel& tissue, const Operated& operated, const Plan& plan,
                std::span<const CutBone> cuts, const StrippingSettings& settings = {});

}  // namespace condyle
