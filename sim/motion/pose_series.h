#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/text_table.h"
#include "engine/math/pose.h"
#include "sim/motion/recording_map.h"

namespace condyle {

/// Poses of one body over time as a file has them: its units and axes already millimetres, radians
/// and its own axes.
struct PoseSeries {
  std::vector<double> time_s;
  std::vector<Pose> X;                   // rest to now
  std::vector<double> residual_mm = {};  // of markers, root mean square; none: no markers
  int missing = 0;                       // rows without a pose, left out
};

/// A rotation nearest to a matrix that is one but for rounding. throws: InputError where it is not
/// (farther than 0.05 in any entry of R'R - 1, or a reflection).
Eigen::Quaterniond rotation_of(const std::filesystem::path& file, const std::string& where,
                               const Eigen::Matrix3d& R);

/// A column of a table by its name, or its number from 1 on ("#3"). throws: InputError listing what
/// there is.
std::size_t column_of(const std::filesystem::path& file, const NumberTable& table,
                      const std::string& name);

/// The body's poses from a table of columns.
PoseSeries poses_from_columns(const std::filesystem::path& file, const NumberTable& table,
                              const RecordingMap& map, const BodyColumns& body,
                              const std::vector<double>& time_s);

/// Places of markers over time: markers[m][r], mm; not finite where not seen.
struct MarkerTable {
  std::vector<std::string> names;
  std::vector<double> time_s;
  std::vector<std::size_t> lines;
  std::vector<std::vector<Eigen::Vector3d>> markers;
};

/// Each row's pose that carries the markers of the first whole row nearest to where they are now,
/// by least squares; rows with fewer than three markers, or with these in a line, are left out.
PoseSeries poses_from_markers(const std::filesystem::path& file, const MarkerTable& table,
                              const std::vector<std::string>& names);

}  // namespace condyle
