#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <string>
#include <vector>

namespace condyle {

/// Unit and axes of a file, parsed once: p_LPS = to_lps_mm() * p_file.
struct SourceFrame {
  std::string units = "mm";  // as declared
  std::string axes = "LPS";  // directions of x, y and z, in capitals
  double unit_mm = 1;
  Eigen::Matrix3d axes_to_lps = Eigen::Matrix3d::Identity();

  Eigen::Matrix3d to_lps_mm() const { return unit_mm * axes_to_lps; }
  /// Left-handed axes: the triangles' orientation must be reversed.
  bool mirrored() const { return axes_to_lps.determinant() < 0; }
};

/// mm per unit: "mm", "cm", "m", "in". throws: InputError naming the known units.
double unit_mm(const std::string& units);

/// `frame` names the directions of the file's three axes: left or right, anterior or posterior,
/// superior or inferior, in any order ("LPS", "RAS", "LSA"; case-insensitive). throws: InputError.
SourceFrame source_frame(const std::string& units, const std::string& frame);

/// All frames, the common ones first: candidates when the declared one does not fit.
const std::vector<std::string>& all_frames();
const std::vector<std::string>& all_units();

}  // namespace condyle
