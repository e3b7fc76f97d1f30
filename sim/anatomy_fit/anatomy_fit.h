#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/case/case.h"

namespace condyle {

/// Surfaces of a patient whose landmarks are not known: mm, closed or open, facing outward, at any
/// position, turned by up to about 30 degrees from LPS. Either `bone`, or `skull`, `mandible` or
/// both.
struct AnatomyScan {
  TriMesh bone;  // skull and lower jaw that are not separated, or one of them
  TriMesh skull, mandible;
  TriMesh skin;                 // where there is one
  std::string source = "scan";  // for messages
};

/// A landmark proposed by the fit.
struct ProposedLandmark {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double uncertainty_mm = 0;  // the fit's local error, and how far the definition moved the point
  bool doubtful = false;
  bool outside_scan = false;  // no surface near it: extrapolated
  std::string reason;         // why it is doubtful
};

/// A surface of the built-in patient carried into the scan.
struct CarriedPart {
  Part part;
  std::vector<float> error_mm;  // of each vertex, distance to the scan; negative: nothing near it
};

/// How well one bone, or the skin, of the built-in patient explains the scan.
struct PartFit {
  bool present = false;
  double rms_mm = 0;   // of the pairs that count
  double covered = 0;  // share of its surface that the scan has
};

enum class ScanFrame {
  lps,          // as expected
  face_behind,  // turned about the vertical axis: RAS coordinates, taken for LPS
  upside_down,  // turned about the transverse axis
  turned_over   // turned about the sagittal axis
};

struct AnatomyFit {
  PartFit skull, mandible, skin;
  double explained = 0;  // share of the bone's outer surface near the fitted template
  ScanFrame frame = ScanFrame::lps;
  std::vector<CarriedPart> parts;
  std::map<std::string, ProposedLandmark> landmarks;
  std::vector<Canal> canals;
  std::vector<std::string> notes;

  const CarriedPart* find(Role role) const {
    for (const auto& carried : parts)
      if (carried.part.role == role) return &carried;
    return nullptr;
  }
};

struct AnatomyFitSettings {
  int threads = 2;
  bool definitions = true;  // landmarks by their own definitions after carrying
};

/// Carries the built-in patient, `model`, into a scan. Deterministic: the same bits for any number
/// of threads.
/// throws: InputError where the surfaces are empty, face inward (left and right are exchanged), or
/// are no skull and no mandible.
AnatomyFit fit_anatomy(const AnatomyScan& scan, const Case& model,
                       const AnatomyFitSettings& settings = {}, const Progress& progress = {});

}  // namespace condyle
