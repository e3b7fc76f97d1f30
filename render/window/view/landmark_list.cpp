#include "render/window/view/landmark_list.h"

#include <cctype>

#include "sim/frame/body_poses.h"
#include "sim/frame/landmark_vertex.h"

namespace condyle {

using Eigen::Vector3d;

Landmark landmark_at(const std::string& name, const Vector3d& at_rest,
                     std::span<const Part> parts) {
  const LandmarkVertex carrier = landmark_vertex(name, at_rest, parts);
  return {name, at_rest, carrier.part, carrier.vertex};
}

Landmark landmark_on(const std::string& name, const PinnedPoint& point,
                     std::span<const Part> parts) {
  Landmark landmark{name, Vector3d::Zero(), point.part, point.triangle[0]};
  double largest = -1;
  for (int k = 0; k < 3; ++k) {
    landmark.at_rest +=
        point.barycentric[k] *
        parts[point.part].mesh.vertices[static_cast<std::size_t>(point.triangle[k])];
    if (point.barycentric[k] <= largest) continue;
    largest = point.barycentric[k];
    landmark.vertex = point.triangle[k];
  }
  return landmark;
}

Vector3d place_of(const Landmark& landmark, std::span<const Part> parts, const FrameState& frame) {
  return place_of(landmark, parts, frame, frame.face);
}

Vector3d place_of(const Landmark& landmark, std::span<const Part> parts, const FrameState& frame,
                  std::span<const Eigen::Vector3f> face) {
  if (face.empty()) face = frame.face;
  if (landmark.part >= parts.size()) return landmark.at_rest;
  const Part& part = parts[landmark.part];
  if (part.role != Role::face) return pose_of(parts[landmark.part], frame.poses) * landmark.at_rest;
  const auto v = static_cast<std::size_t>(landmark.vertex);
  if (face.size() != part.mesh.vertices.size() || v >= face.size()) return landmark.at_rest;
  return landmark.at_rest + face[v].cast<double>() - part.mesh.vertices[v];
}

std::string landmark_name(const std::string& words) {
  std::string name;
  for (const char c : words) {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '\'')
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

}  // namespace condyle
