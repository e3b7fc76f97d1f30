#pragma once

#include "sim/case/case.h"
#include "sim/face_scan/register_face.h"

namespace condyle {

/// What the patient's skin took over from a scan.
struct FaceFusion {
  double covered = 0;   // share of the skin's area
  double moved_mm = 0;  // median distance that it moved there
};

/// Moves the patient's skin onto a registered scan and gives it the scan's colours, in triangles
/// that are small enough for them. Where the scan ends the displacement fades out; the colours of
/// the rest are continued from there. A scan whose mouth is open otherwise moves nothing below the
/// upper lip. Deterministic.
FaceFusion fuse_face(const FaceScan& scan, const FaceRegistration& registration, int threads,
                     Case& patient);

}  // namespace condyle
