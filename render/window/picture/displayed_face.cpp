#include "render/window/picture/displayed_face.h"

#include <algorithm>

#include "render/mesh/vertex_normals.h"

namespace condyle {

namespace {
constexpr std::size_t fewest_triangles = 200;  // of a head; a box is no face
}

DisplayedFace::DisplayedFace(std::span<const Part> parts) {
  const auto face = std::find_if(parts.begin(), parts.end(),
                                 [](const Part& part) { return part.role == Role::face; });
  if (face == parts.end() || face->mesh.triangles.size() < fewest_triangles ||
      !DrawnFace::smooths(face->mesh))
    return;
  std::vector<Eigen::Vector3d> eyes;
  for (const auto& part : parts)
    if (part.role == Role::eyes)
      eyes.insert(eyes.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
  drawn_.emplace(face->mesh, eyes, Eigen::Vector3f::Ones());
  triangles_ = face->mesh.triangles;
  for (const auto& v : face->mesh.vertices) rest_.push_back(v.cast<float>());
}

std::vector<Eigen::Vector3f> DisplayedFace::places(const FrameState& frame) const {
  if (!drawn_) return {};
  const auto& measured = frame.face.size() == rest_.size() ? frame.face : rest_;
  auto places = drawn_->places_of_given(measured);
  std::vector<Eigen::Vector3f> normals;
  vertex_normals(measured, triangles_, normals);
  for (std::size_t v = 0; v < places.size(); ++v)
    places[v] = measured[v] + normals[v].dot(places[v] - measured[v]) * normals[v];
  return places;
}

}  // namespace condyle
