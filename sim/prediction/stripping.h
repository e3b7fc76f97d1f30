#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/operation/operation.h"
#include "sim/plan/plan.h"
#include "sim/tissue/pieces.h"
#include "sim/tissue/tissue.h"

namespace condyle {

/// How far the surgeon lifts the soft tissue off the bone, and how much of its attachment remains.
struct StrippingSettings {
  double reach_mm = 8;       // from a cut line along the bone
  double near_cut = 0.05;    // fraction of the attachment's stiffness that remains there
  double on_maxilla = 0.05;  // the same on the whole front of a Le Fort segment
};

/// Attachments that were stripped.
struct Stripping {
  StrippingSettings settings;
  std::vector<double> kept;  // of each anchor of the tissue: fraction of its stiffness
  int attachments = 0;       // to bone, before
  int near_cuts = 0, on_maxilla = 0;  // number stripped

  int stripped() const { return near_cuts + on_maxilla; }
};

/// The attachments that the cuts of a plan strip. Near a cut line both sides are stripped, except
/// that periosteum stays on the segment of a genioplasty; of a Le Fort I segment the whole front.
/// `cuts`: of the patient of `tissue`, see operated_tissue().
Stripping strip(const TissueModel& tissue, const Operated& operated, const Plan& plan,
                std::span<const CutBone> cuts, const StrippingSettings& settings = {});

}  // namespace condyle
