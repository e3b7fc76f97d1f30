#include "render/camera/camera_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace condyle {

Camera CameraPath::at(double fraction) const {
  if (fraction <= keys.front().at) return keys.front().camera;
  const auto next =
      std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.at > fraction; });
  if (next == keys.end()) return keys.back().camera;
  const Key& a = *(next - 1);
  const Key& b = *next;
  const double t = (fraction - a.at) / (b.at - a.at), s = t * t * (3 - 2 * t);
  const auto between = [&](const auto& from, const auto& to) { return (from + s * (to - from)); };
  const Eigen::Vector3d from = a.camera.direction.normalized(),
                        to = b.camera.direction.normalized();
  Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(from, to);
  // Opposite views leave the axis undetermined: the vertical axis is used, as for a turntable.
  if (from.dot(to) < -1 + 1e-6) turn = Eigen::AngleAxisd(std::acos(-1.0), a.camera.up.normalized());
  const Eigen::Quaterniond part = Eigen::Quaterniond::Identity().slerp(s, turn);
  Camera camera = a.camera;
  camera.target = Eigen::Vector3d(between(a.camera.target, b.camera.target));
  camera.direction = part * from;
  camera.up = Eigen::Vector3d(between(Eigen::Vector3d(part * a.camera.up),
                                      Eigen::Vector3d(part * (turn.inverse() * b.camera.up))));
  if (camera.up.cross(camera.direction).norm() < 1e-6) camera.up = part * a.camera.up;
  camera.distance_mm =
      a.camera.distance_mm * std::pow(b.camera.distance_mm / a.camera.distance_mm, s);
  camera.field_of_view_deg = between(a.camera.field_of_view_deg, b.camera.field_of_view_deg);
  camera.near_mm = between(a.camera.near_mm, b.camera.near_mm);
  return camera;
}

}  // namespace condyle
