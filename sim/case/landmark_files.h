#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/case/landmarks.h"

namespace condyle {

/// One landmark as the file has it.
struct LandmarkRow {
  std::string name;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::string where;  // "line 3", "control point 2"
};

struct LandmarkTable {
  std::vector<LandmarkRow> rows;
  bool own_frame = false;  // the file tells its frame (.mrk.json): the points are LPS, mm
};

/// Reads names and points, unchanged but for a .mrk.json in RAS. throws: InputError.
LandmarkTable read_landmark_table(const std::filesystem::path& file);

/// Gives the rows their canonical names. throws: InputError when two rows mean one landmark and
/// have different places.
Landmarks name_landmarks(const std::filesystem::path& file, const LandmarkTable& table);

/// CSV with a digit string for each number that reads back to the same bits.
std::string landmarks_csv(const Landmarks& landmarks);

}  // namespace condyle
