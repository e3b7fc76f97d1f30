#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/face_scan/face_scan.h"

namespace condyle {

/// A landmark that scan and patient both have.
struct LandmarkResidual {
  std::string name;
  double fiducial_mm = 0;  // after the fit of the landmarks to each other
  double target_mm = 0;    // after the registration of the surfaces, which ignores landmarks
};

/// A scanned face S registered to the skin of a patient C.
struct FaceRegistration {
  Pose X_CS;
  std::vector<LandmarkResidual> landmarks;
  std::optional<double> fiducial_rms_mm, target_rms_mm;  // with three landmarks and more
  // Distances of the scan from the skin above the mouth, absolute.
  double median_mm = 0, p95_mm = 0;
  std::vector<float> residual_mm;  // of each vertex of the scan, positive outside; NaN: no partner
  double covered = 0;              // share of the scan's vertices that have a partner
  // How much lower the scan's chin is than the patient's, mm; absent where it does not show.
  std::optional<double> mouth_opening_mm;
  std::vector<std::string> notes;
};

/// Registers by the landmarks that both have (three and more), else from the axes of the scan, also
/// turned about; then by trimmed iterated closest points, at last above the mouth alone. Bitwise
/// deterministic for any number of threads.
/// `landmarks`: in the scan's frame, with canonical names. `source`: for messages.
/// throws: InputError where the patient has no skin, landmarks do not lie on the scan or do not
/// fit, the surfaces do not match, or the scan's mirror image fits far better (a little better: a
/// note).
FaceRegistration register_face(const FaceScan& scan, const Landmarks& landmarks,
                               const Case& patient, const std::string& source, int threads);

}  // namespace condyle
