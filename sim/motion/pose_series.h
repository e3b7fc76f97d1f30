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

/// Poses of one body over time in the axes of the file, converted to millimetres and radians.
struct PoseSeries {
  std::vector<double> time_s;
  std::vector<Pose> X;                   // rest to now
  std::vector<double> residual_mm = {};  // root mean square over the markers; empty without markers
  int missing = 0;                       // rows without a pose, omitted
};

/// The rotation nearest to a matrix that is orthogonal up to rounding. throws: InputError where an
/// entry of R'R - 1 exceeds 0.05, or for a reflection.
Eigen::Quaterniond rotation_of(const std::filesystem::path& file, const std::string& where,
                               const Eigen::Matrix3d& R);

/// Index of a column given by its name, or by its number from 1 ("#3"). throws: InputError listing
/// the columns.
std::size_t column_of(const std::filesystem::path& file, const NumberTable& table,
                      const std::string& name);

/// The body's poses from a table of columns.
PoseSeries poses_from_columns(const std::filesystem::path& file, const NumberTable& table,
                              const RecordingMap& map, const BodyColumns& body,
                              const std::vector<double>& time_s);

/// Positions of markers over time: markers[m][r], mm; not finite where not visible.
struct MarkerTable {
  std::vector<std::string> names;
  std::vector<double> time_s;
  std::vector<std::size_t> lines;
  std::vector<std::vector<Eigen::Vector3d>> markers;
};

/// Least-squares rigid pose of each row relative to the first complete row. Rows with fewer than
/// three visible markers, or with collinear ones, are omitted.
PoseSeries poses_from_markers(const std::filesystem::path& file, const MarkerTable& table,
                              const std::vector<std::string>& names);

}  // namespace condyle
