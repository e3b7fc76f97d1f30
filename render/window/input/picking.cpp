#include "render/window/input/picking.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

namespace condyle {

std::optional<PickedPoint> pick_point(const Camera& camera, const ViewRect& view,
                                      const Eigen::Vector2d& mouse,
                                      std::span<const PickableSurface> surfaces) {
  using Eigen::Vector3d;
  const Eigen::Matrix3d axes = picture_axes(camera);
  const double half = std::tan(camera.field_of_view_deg * std::numbers::pi / 360);
  const double x = (2 * (mouse.x() - view.x) / view.width - 1) * half * view.width / view.height;
  const double y = (1 - 2 * (mouse.y() - view.y) / view.height) * half;
  const Vector3d eye = camera.target + camera.distance_mm * axes.row(2).transpose();
  const Vector3d ray = axes.transpose() * Vector3d(x, y, -1);

  std::optional<PickedPoint> found;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const TriMesh* mesh = surfaces[s].mesh;
    const Pose& X_WS = surfaces[s].X_WS;
    const Pose X_SW = X_WS.inverse();
    const Vector3d from = X_SW * eye, along = X_SW.R * ray;
    for (const auto& t : mesh->triangles) {
      const Vector3d a = mesh->vertices[t[0]] - from, b = mesh->vertices[t[1]] - from,
                     c = mesh->vertices[t[2]] - from;
      // Signed volumes of the ray with each edge; all of one sign if it passes through.
      const double u = along.dot(c.cross(b)), v = along.dot(a.cross(c)), w = along.dot(b.cross(a));
      if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) continue;
      const double sum = u + v + w;
      if (sum == 0) continue;
      const double depth = (u * a + v * b + w * c).dot(along) / (sum * along.squaredNorm());
      if (!(depth > 0) || depth >= nearest) continue;
      nearest = depth;
      found = {s, t, Vector3d(u, v, w) / sum, eye + depth * ray};
    }
  }
  return found;
}

std::optional<PickedValue> pick_value(const Camera& camera, const ViewRect& view,
                                      const Eigen::Vector2d& mouse,
                                      std::span<const PickableSurface> surfaces) {
  const auto found = pick_point(camera, view, mouse, surfaces);
  if (!found) return std::nullopt;
  float value = 0;
  for (int k = 0; k < 3; ++k)
    if (found->barycentric[k] > 0)
      value += static_cast<float>(found->barycentric[k]) *
               surfaces[found->surface].values[found->triangle[k]];
  return PickedValue{found->surface, value};
}

}  // namespace condyle
