#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/case/landmarks.h"

namespace condyle {

/// One landmark as given in the file.
struct LandmarkRow {
  std::string name;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::string where;  // "line 3", "control point 2"
};

struct LandmarkTable {
  std::vector<LandmarkRow> rows;
  bool own_frame = false;  // the file defines its frame (.mrk.json): the points are LPS, mm
};

/// Reads names and points; those of a .mrk.json in RAS are converted to LPS. throws: InputError.
LandmarkTable read_landmark_table(const std::filesystem::path& file);

/// The same for points that need no names, such as those of a line: the column `name` may be
/// absent.
LandmarkTable read_point_table(const std::filesystem::path& file);

/// Replaces names by canonical ones. throws: InputError when two rows name the same landmark at
/// different positions.
Landmarks name_landmarks(const std::filesystem::path& file, const LandmarkTable& table);

/// The landmarks as CSV with exact round trip.
std::string landmarks_csv(const Landmarks& landmarks);

}  // namespace condyle
