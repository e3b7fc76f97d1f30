#pragma once

#include <cstdint>

#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/face_scan/depth_map.h"

namespace condyle {

struct LaserSettings {
  int columns = 600, rows = 640;
  double height_mm = 320;
  double angle_from_deg = -120, angle_to_deg = 120;
  double noise_mm = 0.1;   // standard deviation of the depth
  double spikes = 0.001;   // share of the samples
  std::uint64_t seed = 1;  // of pose, noise and gaps
  int threads = 1;
};

/// A cylindrical laser scan of a patient's face.
struct LaserScan {
  FaceDepthMap map;
  Pose X_SC;  // the patient in the scanner's frame
};

/// Face and eyes of the patient as a laser scanner sees them, turned by up to 5 degrees and moved
/// by up to 10 mm: rays towards the axis, noise, spikes, gaps in dark hair and where the ray grazes
/// the skin. Bit-identical for any number of threads.
LaserScan scan_laser(const Case& patient, const LaserSettings& settings);

}  // namespace condyle
