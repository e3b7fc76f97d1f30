#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "engine/mesh/tri_mesh.h"
#include "render/camera/camera.h"
#include "render/image/image.h"
#include "sim/frame/part.h"

namespace condyle {

/// Ball of latitude rings, closed, outward.
inline TriMesh ball(const Eigen::Vector3d& centre, double radius_mm, int rings = 48) {
  TriMesh mesh;
  const int columns = 2 * rings;
  mesh.vertices.push_back(centre + Eigen::Vector3d(0, 0, radius_mm));
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < columns; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / columns;
      mesh.vertices.push_back(centre + radius_mm * Eigen::Vector3d(std::sin(a) * std::cos(b),
                                                                   std::sin(a) * std::sin(b),
                                                                   std::cos(a)));
    }
  mesh.vertices.push_back(centre - Eigen::Vector3d(0, 0, radius_mm));
  const auto at = [&](int i, int j) { return 1 + (i - 1) * columns + j % columns; };
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  for (int j = 0; j < columns; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

inline Part make_part(const std::string& name, Role role, TriMesh mesh) {
  return {name, role, std::move(mesh), {}};
}

struct Pixel {
  int r, g, b, a;
};
inline Pixel pixel(const Image& image, int x, int y) {
  const auto* p = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
  return {p[0], p[1], p[2], p[3]};
}

/// Views along +y from 500 mm in front; the picture is `height_mm` high at the origin.
inline Camera front_camera(double height_mm = 100) {
  Camera camera;
  camera.distance_mm = 500;
  camera.field_of_view_deg = 2 * std::atan(height_mm / 2 / 500) * 180 / std::numbers::pi;
  return camera;
}

}  // namespace condyle
