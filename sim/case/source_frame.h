#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace condyle {

/// How a file's coordinates become LPS mm: p_LPS = to_lps_mm * p_file.
struct SourceFrame {
  Eigen::Matrix3d to_lps_mm = Eigen::Matrix3d::Identity();
  bool mirrored = false;  // left-handed axes: triangles must be turned over
};

/// mm per unit: "mm", "cm", "m", "in". throws: InputError naming the known units.
double unit_mm(const std::string& units);

/// `frame` names where the file's three axes point: left or right, anterior or posterior, superior
/// or inferior, in any order ("LPS", "RAS", "LSA"; case-blind). throws: InputError.
SourceFrame source_frame(const std::string& units, const std::string& frame);

/// All frames, the usual ones first: candidates when the declared one does not fit.
const std::vector<std::string>& all_frames();
const std::vector<std::string>& all_units();

}  // namespace condyle
