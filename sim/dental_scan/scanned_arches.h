#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/dental_scan/arch_fit.h"
#include "sim/dental_scan/scanned_bite.h"

namespace condyle {

struct ScannedArchesRequest {
  std::optional<DentalScan> upper, lower;  // one or both
  Landmarks upper_picks = {}, lower_picks = {};
  bool accept_residual = false;  // fits that are refused otherwise
  int threads = 2;
};

/// A bone of the case from which crowns were removed, or could not be.
struct TrimmedBone {
  std::string part;
  double removed_mm3 = 0;
  int open_edges = 0;  // of a surface that is not closed, and stayed as it was
};

/// A case whose crowns are those of dental scans.
struct ScannedArches {
  Case patient;
  std::optional<ArchFit> upper, lower;
  std::vector<TrimmedBone> upper_bones, lower_bones;  // that reached the scan's crowns
  std::optional<ScannedBite> together;                // of two scans
  std::optional<BiteError> bite;                      // where they were scanned in occlusion
  std::vector<std::string> notes;                     // also at the end of the patient's
};

/// Registers scans to the crowns of the case and replaces these: closed by a skirt below the rim,
/// with the FDI numbers of the nearest teeth. Crowns that bones carry besides their teeth are
/// removed (carried_crowns.h). The bite of scans in occlusion becomes that of the
/// case (Case::X_CM_bite). `notes` of the case tell what was found. throws: InputError for a case
/// without these crowns, and for scans that are mirrored, exchanged or do not fit.
ScannedArches with_scanned_arches(Case patient, const ScannedArchesRequest& request,
                                  const Progress& progress = {});

/// A case of dental scans alone. Their attitude is found by registration to the crowns of `model`,
/// the built-in patient; scans in occlusion stay in it, others lie as the model's arches do. The
/// condyles are placed by Bonwill's triangle and Balkwill's angle.
ScannedArches case_of_scanned_arches(const ScannedArchesRequest& request, const Case& model,
                                     const Progress& progress = {});

}  // namespace condyle
