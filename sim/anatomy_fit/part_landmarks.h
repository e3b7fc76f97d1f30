#pragma once

#include "engine/registration/elastic_fit.h"
#include "sim/anatomy_fit/anatomy_fit.h"

namespace condyle {

/// One fitted surface, and what is needed to judge points that it carries.
struct FittedPart {
  Role role = Role::skull;
  const FitSurface* moving = nullptr;
  const FitSurface* target = nullptr;
  ElasticFit fit;
  std::vector<float> error_mm;  // of each sample; negative: nothing of the scan near it
  double covered = 0;           // share of the samples with something near
};

/// Distances of the samples of a fitted part to the scan; what lies nearer to `other`, the other
/// bone as fitted, is not a partner.
void measure_errors(FittedPart& part, int threads, const TriangleTree* other = nullptr);

/// Distance of carried points to the scan; negative where nothing with an agreeing normal is near.
std::vector<float> errors_of(const TriMesh& carried, const FitSurface& target, int threads);

/// The landmarks that belong to a part, carried, with the fit's local error.
std::map<std::string, ProposedLandmark> carried_landmarks(const FittedPart& part,
                                                          const Case& model);

}  // namespace condyle
