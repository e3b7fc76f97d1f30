#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/source_frame.h"

namespace condyle {

/// The columns of a recording that hold the pose of a body, or its markers.
struct BodyColumns {
  enum class Rotation { none, quaternion, euler, matrix } rotation = Rotation::none;
  std::vector<std::string> translation = {};  // three; empty with a 4x4 matrix
  std::vector<std::string> turn = {};         // w x y z; three angles; 9 or 16 entries, row by row
  std::string order = "XYZ";  // of Euler angles: capitals for intrinsic rotations, lower case
                              // for extrinsic ones
  std::vector<std::string> markers = {};  // instead of columns: three or more
};

/// Conversion of a file's numbers to X_CM. Poses in the file map rest to now in its own axes.
struct RecordingMap {
  std::string time = "time_s";
  double time_unit_s = 1;
  double rate_hz = 0;  // of rows without times
  double length_unit_mm = 1;
  double angle_unit_rad = 1;
  SourceFrame source = {};                              // directions of the file's x, y and z
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();  // the file's origin, in the case's frame
  bool first_is_rest = false;  // poses are relative to that of the first row
  double smooth_hz = 0;        // cutoff of the low-pass filter; 0: none
  BodyColumns mandible = {};
  std::optional<BodyColumns> cranium =
      {};  // if recorded, its motion is subtracted from the mandible's
};

/// Reads a sidecar file (FILE.json for the recording FILE) on top of the defaults of its format.
/// All keys are optional:
/// {"time": COLUMN, "time_unit": "s|ms", "rate_hz": 100, "length_unit": "mm|cm|m|in", "angle_unit":
/// "deg|rad", "axes": "LPS", "origin_mm": [x, y, z], "rest": "first|identity", "smooth_hz": 10,
/// "mandible": BODY, "cranium": BODY}; BODY is {"translation": [3 columns], "quaternion": [w, x, y,
/// z]}, {"translation": [...], "euler": [3 columns], "order": "XYZ"}, {"translation": [...],
/// "matrix": [9]}, {"matrix": [16]} or {"markers": [names]}. throws: InputError.
RecordingMap read_sidecar(const std::filesystem::path& file, RecordingMap defaults);

}  // namespace condyle
