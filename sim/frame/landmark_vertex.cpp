#include "sim/frame/landmark_vertex.h"

#include <limits>

namespace condyle {
namespace {

/// The nearest vertex of a part, if it is nearer than `nearest`.
void look(std::span<const Part> parts, std::size_t part, const Eigen::Vector3d& p, double& nearest,
          LandmarkVertex& found) {
  const auto& vertices = parts[part].mesh.vertices;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const double away = (vertices[v] - p).squaredNorm();
    if (away >= nearest) continue;
    nearest = away;
    found = {part, static_cast<int>(v)};
  }
}

}  // namespace

LandmarkVertex landmark_vertex(std::string_view landmark, const Eigen::Vector3d& at_rest,
                               std::span<const Part> parts) {
  LandmarkVertex found;
  double nearest = std::numeric_limits<double>::infinity();
  const bool of_condyle = landmark.ends_with("condyle") || landmark.ends_with("condylion");
  for (std::size_t i = 0; of_condyle && i < parts.size(); ++i)
    if (parts[i].role == Role::mandible || is_piece(parts[i].role))
      look(parts, i, at_rest, nearest, found);
  if (nearest < std::numeric_limits<double>::infinity()) return found;
  for (std::size_t i = 0; i < parts.size(); ++i) look(parts, i, at_rest, nearest, found);
  return found;
}

}  // namespace condyle
