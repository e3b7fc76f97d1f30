#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/math/pose.h"

namespace condyle {

/// Names of a recording's cameras: the view of the window, and the same with one turn around the
/// patient.
inline constexpr const char* own_camera = "view";
inline constexpr const char* turning_camera = "turning";

/// Perspective camera aimed at a point of the case, mm, LPS.
struct Camera {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = {0, -1, 0};  // unit, from the target towards the eye
  Eigen::Vector3d up = {0, 0, 1};
  double distance_mm = 600;
  double field_of_view_deg = 24;  // vertical
  double near_mm = 0;             // near plane: closer geometry is cut away
};

/// Names of the standard views: front back left right three-quarter above below. `spin` is a
/// turntable about the vertical axis, one turn over the recording.
const std::vector<std::string>& camera_names();

/// A standard view that fits the box [low, high] with a margin.
/// throws: InputError for an unknown name, listing the valid ones.
Camera standard_camera(const std::string& name, const Eigen::Vector3d& low,
                       const Eigen::Vector3d& high, double aspect);

/// The same camera expressed in frame B, given in frame A.
Camera expressed_in(const Pose& X_BA, const Camera& camera);

/// Rotated about the vertical axis through the target, or about another axis.
Camera turned(const Camera& camera, double angle_rad,
              const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ());

Eigen::Matrix4f view_matrix(const Camera& camera);
Eigen::Matrix4f projection_matrix(const Camera& camera, double aspect, double near_mm,
                                  double far_mm);

}  // namespace condyle
