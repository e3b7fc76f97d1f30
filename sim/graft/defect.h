#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Face of the bone that stays, where a segment was resected.
struct DefectFace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // its middle
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // unit, out of the bone into the defect
  double area_mm2 = 0;
  double kerf_mm = 0;  // that the saw took between it and the resected segment
};

/// A gap in the jaw between two plane faces, at the uncut rest.
struct Defect {
  std::array<DefectFace, 2> faces;  // seen from outside and above, from left to right
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
};

/// The faces that a resected bone leaves: its own cut faces, moved by the kerf of the step that
/// made each. `made_by`: of each triangle the step that cut it, 0 on the bone's surface.
/// `jaw_middle`: a point that the gap is seen from inside of the jaw.
/// throws: InputError for a bone without two plane cut faces.
Defect find_defect(const TriMesh& resected, const std::vector<int>& made_by,
                   const std::function<double(int step)>& kerf_mm, const Eigen::Vector3d& up,
                   const Eigen::Vector3d& jaw_middle);

/// Points along the lower border of a resected bone from face to face: each lies `height_mm` above
/// the border of the section there, in the middle of its width. The first and last lie in the
/// faces.
std::vector<Eigen::Vector3d> border_curve(const TriMesh& resected, const Defect& defect,
                                          double height_mm);

/// A polyline of the user's from face to face: turned to run from the first to the second, and cut
/// or extended to end in their planes. throws: InputError where its ends run beside a face.
std::vector<Eigen::Vector3d> curve_between(std::vector<Eigen::Vector3d> curve,
                                           const Defect& defect);

}  // namespace condyle
