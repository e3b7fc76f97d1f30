#include "sim/motion/pose_series.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double unit_tolerance = 1e-3;      // of a quaternion's norm, for files with few digits
constexpr double rotation_tolerance = 0.05;  // for matrices written with two decimals
constexpr double farthest_mm = 1000;
constexpr double max_angle_rad = 7;  // slightly more than a full turn

Quaterniond about(char axis, double angle) {
  const int k = std::tolower(static_cast<unsigned char>(axis)) - 'x';
  return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::Unit(k)));
}

/// Indices of a body's columns in the table.
std::vector<std::size_t> column_indices(const std::filesystem::path& file, const NumberTable& table,
                                        const std::vector<std::string>& names) {
  std::vector<std::size_t> out;
  for (const auto& name : names) out.push_back(column_of(file, table, name));
  return out;
}

const char* unit_name(double unit_mm) {
  return unit_mm == 1000 ? "metres"
         : unit_mm == 10 ? "centimetres"
         : unit_mm == 1  ? "millimetres"
                         : "inches";
}

}  // namespace

Quaterniond rotation_of(const std::filesystem::path& file, const std::string& where,
                        const Matrix3d& R) {
  const double off = (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= rotation_tolerance))
    throw InputError(
        file, where,
        fmt::format("the 3x3 part is not a rotation: R'R differs from 1 by {:.3g} (its "
                    "first row is {:.4g} {:.4g} {:.4g}); use poses without scale or "
                    "shear, and check the assignment of columns",
                    off, R(0, 0), R(0, 1), R(0, 2)));
  if (R.determinant() < 0)
    throw InputError(file, where,
                     "the 3x3 part is a reflection, not a rotation. Use poses of a right-handed "
                     "frame");
  const Eigen::JacobiSVD<Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Quaterniond(Matrix3d(svd.matrixU() * svd.matrixV().transpose())).normalized();
}

std::size_t column_of(const std::filesystem::path& file, const NumberTable& table,
                      const std::string& name) {
  if (name.starts_with('#')) {
    const double number = parse_number(file, "sidecar, column " + name, name.substr(1));
    if (number >= 1 && number <= static_cast<double>(table.names.size()) &&
        number == std::floor(number))
      return static_cast<std::size_t>(number) - 1;
    throw InputError(file, "",
                     fmt::format("there is no column {}; the file has {} columns", shortened(name),
                                 table.names.size()));
  }
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < table.names.size(); ++c)
    if (lower_case(table.names[c]) == lower_case(name)) found.push_back(c);
  if (found.size() == 1) return found[0];
  std::string there;
  for (std::size_t c = 0; c < std::min<std::size_t>(table.names.size(), 20); ++c)
    there += (c ? ", " : "") + shortened(table.names[c]);
  throw InputError(file, fmt::format("line {}", table.header_line),
                   found.empty() ? fmt::format("column {} is missing; the columns are {}",
                                               shortened(name), there)
                                 : fmt::format("column {} appears twice", shortened(name)));
}

PoseSeries poses_from_columns(const std::filesystem::path& file, const NumberTable& table,
                              const RecordingMap& map, const BodyColumns& body,
                              const std::vector<double>& time_s) {
  using Rotation = BodyColumns::Rotation;
  const auto shift = column_indices(file, table, body.translation),
             turn = column_indices(file, table, body.turn);
  PoseSeries series;
  series.time_s = time_s;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const auto value = [&](std::size_t k) { return table.at(r, turn[k]); };
    const std::string line = "line " + std::to_string(table.lines[r]);
    Pose X;
    if (body.rotation == Rotation::quaternion) {
      X.R = Quaterniond(value(0), value(1), value(2), value(3));
      const double length = X.R.norm();
      if (!(std::abs(length - 1) <= unit_tolerance))
        throw InputError(
            file, fmt::format("{}, {}", line, fmt::join(body.turn, " ")),
            fmt::format("the quaternion ({}, {}, {}, {}) has length {:.6g}; it must be 1", value(0),
                        value(1), value(2), value(3), length));
      X.R.normalize();
    } else if (body.rotation == Rotation::euler) {
      std::array<Quaterniond, 3> turns;
      for (std::size_t k = 0; k < 3; ++k) {
        const double angle = value(k) * map.angle_unit_rad;
        if (std::abs(angle) > max_angle_rad)
          throw InputError(file, table.where(r, turn[k]),
                           fmt::format("{} is more than a full turn in {}; check angle_unit",
                                       value(k), map.angle_unit_rad == 1 ? "radians" : "degrees"));
        turns[k] = about(body.order[k], angle);
      }
      const bool along = std::isupper(static_cast<unsigned char>(body.order[0])) != 0;
      X.R = (along ? turns[0] * turns[1] * turns[2] : turns[2] * turns[1] * turns[0]).normalized();
    } else {
      const std::size_t width = turn.size() == 16 ? 4 : 3;
      Matrix3d R;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          R(static_cast<int>(i), static_cast<int>(j)) = value(width * i + j);
      if (width == 4) {
        bool by_rows = value(12) == 0 && value(13) == 0 && value(14) == 0 && value(15) == 1;
        const bool by_columns = value(3) == 0 && value(7) == 0 && value(11) == 0 && value(15) == 1;
        if (!by_rows && !by_columns)
          throw InputError(file, line,
                           fmt::format("the last row of a 4x4 pose must be 0 0 0 1; here it is {} "
                                       "{} {} {}",
                                       value(12), value(13), value(14), value(15)));
        X.t = map.length_unit_mm * (by_rows ? Vector3d(value(3), value(7), value(11))
                                            : Vector3d(value(12), value(13), value(14)));
        if (!by_rows) R.transposeInPlace();  // stored column by column
      }
      X.R = rotation_of(
          file, fmt::format("{}, columns {} to {}", line, body.turn.front(), body.turn.back()), R);
    }
    for (std::size_t k = 0; k < shift.size(); ++k) {
      const double mm = table.at(r, shift[k]) * map.length_unit_mm;
      X.t[static_cast<int>(k)] = mm;
      if (!map.first_is_rest && std::abs(mm) > farthest_mm)
        throw InputError(
            file, table.where(r, shift[k]),
            fmt::format("{:.6g} mm exceeds {} mm; lengths are read in {}. For another unit, add "
                        "the sidecar "
                        "file {}.json with {{\"length_unit\": ...}} (mm, cm, m or in)",
                        mm, farthest_mm, unit_name(map.length_unit_mm), file.filename().string()));
    }
    series.X.push_back(X);
  }
  return series;
}

PoseSeries poses_from_markers(const std::filesystem::path& file, const MarkerTable& table,
                              const std::vector<std::string>& names) {
  std::vector<const std::vector<Vector3d>*> tracks;
  for (const auto& name : names) {
    const auto found = std::find(table.names.begin(), table.names.end(), name);
    if (found == table.names.end())
      throw InputError(file, "header",
                       fmt::format("the marker {} is missing; the markers are {}", shortened(name),
                                   shortened(fmt::format("{}", fmt::join(table.names, ", ")))));
    tracks.push_back(&table.markers[static_cast<std::size_t>(found - table.names.begin())]);
  }
  const auto seen = [&](std::size_t r) {
    std::vector<std::size_t> out;
    for (std::size_t m = 0; m < tracks.size(); ++m)
      if ((*tracks[m])[r].allFinite()) out.push_back(m);
    return out;
  };
  std::size_t first = 0;
  while (first < table.time_s.size() && seen(first).size() < tracks.size()) ++first;
  if (first == table.time_s.size())
    throw InputError(file, "", "no row contains all markers of the body");

  PoseSeries series;
  for (std::size_t r = 0; r < table.time_s.size(); ++r) {
    const auto here = seen(r);
    Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
    for (const std::size_t m : here) {
      a += (*tracks[m])[first] / static_cast<double>(here.size());
      b += (*tracks[m])[r] / static_cast<double>(here.size());
    }
    Matrix3d spread = Matrix3d::Zero(), H = Matrix3d::Zero();
    for (const std::size_t m : here) {
      const Vector3d u = (*tracks[m])[first] - a, v = (*tracks[m])[r] - b;
      spread += u * u.transpose();
      H += u * v.transpose();
    }
    const Eigen::JacobiSVD<Matrix3d> shape(spread);
    constexpr double thin = 1e-4;  // ratio of squared extents below which markers are collinear
    if (here.size() < 3 || shape.singularValues()[1] <= thin * shape.singularValues()[0]) {
      if (r == first)
        throw InputError(file, "line " + std::to_string(table.lines[r]),
                         "the markers are collinear and determine no rotation");
      ++series.missing;
      continue;
    }
    const Eigen::JacobiSVD<Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d mirror = Matrix3d::Identity();
    mirror(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
    Pose X;
    X.R = Quaterniond(Matrix3d(svd.matrixV() * mirror * svd.matrixU().transpose())).normalized();
    X.t = b - X.R * a;
    double squares = 0;
    for (const std::size_t m : here)
      squares += (X * (*tracks[m])[first] - (*tracks[m])[r]).squaredNorm();
    series.time_s.push_back(table.time_s[r]);
    series.X.push_back(X);
    series.residual_mm.push_back(std::sqrt(squares / static_cast<double>(here.size())));
  }
  return series;
}

}  // namespace condyle
