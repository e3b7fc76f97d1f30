#include "render/window/view/measuring.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sim/frame/body_poses.h"

namespace condyle {

using Eigen::Vector3d;

Vector3d place_of(const PinnedPoint& point, std::span<const Part> parts, const FrameState& frame) {
  return place_of(point, parts, frame, frame.face);
}

Vector3d place_of(const PinnedPoint& point, std::span<const Part> parts, const FrameState& frame,
                  std::span<const Eigen::Vector3f> face) {
  if (face.empty()) face = frame.face;
  const Part& part = parts[point.part];
  const bool deformed = part.role == Role::face && face.size() == part.mesh.vertices.size();
  Vector3d p = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(point.triangle[k]);
    p += point.barycentric[k] * (deformed ? face[v].cast<double>() : part.mesh.vertices[v]);
  }
  return deformed ? p : pose_of(parts[point.part], frame.poses) * p;
}

Measured measured(std::span<const Vector3d> points) {
  Measured result;
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    result.length_mm += (points[i + 1] - points[i]).norm();
  if (points.size() == 3) {
    const Vector3d a = points[0] - points[1], b = points[2] - points[1];
    result.angle_deg = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
  }
  if (points.size() >= 3) {
    Vector3d twice = Vector3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i)
      twice += (points[i] - points[0]).cross(points[(i + 1) % points.size()] - points[0]);
    result.area_mm2 = twice.norm() / 2;
  }
  return result;
}

std::vector<std::string> words_of(const Measured& measured) {
  std::vector<std::string> words = {fmt::format("{:.1f} mm", measured.length_mm)};
  if (measured.angle_deg) words.push_back(fmt::format("{:.1f}\u00b0", *measured.angle_deg));
  if (measured.area_mm2) words.push_back(fmt::format("{:.0f} mm\u00b2", *measured.area_mm2));
  return words;
}

}  // namespace condyle
