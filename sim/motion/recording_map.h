#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace condyle {

/// Which columns of a recording hold the pose of a body, or which markers it carries.
struct BodyColumns {
  enum class Rotation { none, quaternion, euler, matrix } rotation = Rotation::none;
  std::vector<std::string> translation = {};  // three; none with a whole matrix
  std::vector<std::string> turn = {};         // w x y z; three angles; 9 or 16 entries, row by row
  std::string order = "XYZ";  // of Euler angles: capitals turn about axes that go along, small
                              // letters about axes that stay
  std::vector<std::string> markers = {};  // in place of all that: three or more
};

/// How a file's numbers become X_CM. Poses in the file map rest to now in its own axes.
struct RecordingMap {
  std::string time = "time_s";
  double time_unit_s = 1;
  double rate_hz = 0;  // of rows without times
  double length_unit_mm = 1;
  double angle_unit_rad = 1;
  std::string axes = "LPS";                             // where the file's x, y and z point
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();  // the file's origin, in the case's frame
  bool first_is_rest = false;                           // poses count from that of the first row
  double smooth_hz = 0;  // jitter faster than this is taken out; 0: nothing is
  BodyColumns mandible = {};
  std::optional<BodyColumns> cranium = {};  // moves in the file too: the mandible counts against it
};

/// Reads a sidecar (FILE.json beside the recording) over what a format takes for granted. All keys
/// are optional:
/// {"time": COLUMN, "time_unit": "s|ms", "rate_hz": 100, "length_unit": "mm|cm|m|in", "angle_unit":
/// "deg|rad", "axes": "LPS", "origin_mm": [x, y, z], "rest": "first|identity", "smooth_hz": 10,
/// "mandible": BODY, "cranium": BODY}; BODY is {"translation": [3 columns], "quaternion": [w, x, y,
/// z]}, {"translation": [...], "euler": [3 columns], "order": "XYZ"}, {"translation": [...],
/// "matrix": [9]}, {"matrix": [16]} or {"markers": [names]}. throws: InputError.
RecordingMap read_sidecar(const std::filesystem::path& file, RecordingMap usual);

}  // namespace condyle
