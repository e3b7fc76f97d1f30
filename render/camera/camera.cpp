#include "render/camera/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"

namespace condyle {
namespace {

/// Right, up and towards the eye, as rows.
Eigen::Matrix3d axes(const Camera& camera) {
  const Eigen::Vector3d back = camera.direction.normalized();
  Eigen::Vector3d right = camera.up.cross(back);
  // A view along `up` leaves the roll undetermined: the patient's left-right axis is used.
  if (right.norm() < 1e-9 * camera.up.norm()) right = Eigen::Vector3d::UnitX();
  right.normalize();
  Eigen::Matrix3d rows;
  rows << right.transpose(), back.cross(right).transpose(), back.transpose();
  return rows;
}

struct View {
  const char* name;
  Eigen::Vector3d direction, up;
};

const std::vector<View>& views() {
  static const std::vector<View> all = {
      {"front", {0, -1, 0}, {0, 0, 1}},
      {"back", {0, 1, 0}, {0, 0, 1}},
      {"left", {1, 0, 0}, {0, 0, 1}},
      {"right", {-1, 0, 0}, {0, 0, 1}},
      {"three-quarter", {0.64, -0.76, 0.1}, {0, 0, 1}},
      {"above", {0, 0, 1}, {0, -1, 0}},  // the face at the top of the picture
      {"below", {0, 0, -1}, {0, -1, 0}},
  };
  return all;
}

}  // namespace

const std::vector<std::string>& camera_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> found;
    for (const auto& view : views()) found.emplace_back(view.name);
    return found;
  }();
  return names;
}

Camera standard_camera(const std::string& name, const Eigen::Vector3d& low,
                       const Eigen::Vector3d& high, double aspect) {
  const auto view = std::find_if(views().begin(), views().end(),
                                 [&](const View& candidate) { return name == candidate.name; });
  if (view == views().end()) {
    std::string known;
    for (const auto& other : camera_names()) known += (known.empty() ? "" : ", ") + other;
    throw InputError("camera '" + name + "' is unknown; use one of: " + known +
                     ", spin, upper-arch, lower-arch, or a .json file");
  }
  constexpr double air = 1.08;
  Camera camera;
  camera.target = 0.5 * (low + high);
  camera.direction = view->direction.normalized();
  camera.up = view->up;
  const double slope_y = std::tan(camera.field_of_view_deg * std::numbers::pi / 360) / air;
  const double slope_x = slope_y * aspect;
  const Eigen::Matrix3d rows = axes(camera);
  camera.distance_mm = 1;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                            corner & 4 ? high.z() : low.z());
    const Eigen::Vector3d q = rows * (p - camera.target);
    camera.distance_mm = std::max(
        {camera.distance_mm, q.z() + std::abs(q.x()) / slope_x, q.z() + std::abs(q.y()) / slope_y});
  }
  return camera;
}

Camera expressed_in(const Pose& X_BA, const Camera& camera) {
  Camera there = camera;
  there.target = X_BA * camera.target;
  there.direction = X_BA.R * camera.direction;
  there.up = X_BA.R * camera.up;
  return there;
}

Camera turned(const Camera& camera, double angle_rad, const Eigen::Vector3d& axis) {
  const Eigen::AngleAxisd turn(angle_rad, axis);
  Camera result = camera;
  result.direction = turn * camera.direction;
  result.up = turn * camera.up;
  return result;
}

Eigen::Matrix4f view_matrix(const Camera& camera) {
  const Eigen::Matrix3d rows = axes(camera);
  const Eigen::Vector3d eye = camera.target + camera.distance_mm * camera.direction.normalized();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = rows;
  view.topRightCorner<3, 1>() = -rows * eye;
  return view.cast<float>();
}

Eigen::Matrix4f projection_matrix(const Camera& camera, double aspect, double near_mm,
                                  double far_mm) {
  const double f = 1 / std::tan(camera.field_of_view_deg * std::numbers::pi / 360);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = f / aspect;
  projection(1, 1) = f;
  projection(2, 2) = (far_mm + near_mm) / (near_mm - far_mm);
  projection(2, 3) = 2 * far_mm * near_mm / (near_mm - far_mm);
  projection(3, 2) = -1;
  return projection.cast<float>();
}

}  // namespace condyle
