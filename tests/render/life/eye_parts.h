#pragma once

#include <algorithm>
#include <cmath>

#include "tests/render/scene_parts.h"

namespace condyle {

inline const Eigen::Vector3d eye_centre(31, -70, 12);
constexpr double cornea_mm = 0.7;

/// An eyeball with a cornea that bulges further than the lids are away from it.
inline TriMesh eyeball() {
  constexpr double ball_mm = 12;
  TriMesh mesh = ball(eye_centre, ball_mm, 60);
  for (auto& p : mesh.vertices) {
    const Eigen::Vector3d v = (p - eye_centre) / ball_mm;
    const double off = std::acos(std::clamp(-v.y(), -1.0, 1.0));
    p += cornea_mm * std::exp(-std::pow(off / 0.35, 2)) * v;
  }
  return mesh;
}

/// A thin skin round the eyeball with an opening as between lids, tilted. around: its triangles.
inline TriMesh open_lids(int around = 120) {
  constexpr double lid_mm = 12.2;
  TriMesh mesh = ball(eye_centre, lid_mm, around);
  std::erase_if(mesh.triangles, [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d p =
        (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3 - eye_centre;
    const double x = p.x() / 10.5, z = (p.z() - 0.1 * p.x()) / (p.z() > 0.1 * p.x() ? 4.4 : 4);
    return p.y() < 0 && x * x + std::abs(z) < 1;
  });
  for (auto& p : mesh.vertices)  // outside the cornea, as a real lid is
    if (const Eigen::Vector3d v = (p - eye_centre) / lid_mm; v.y() < 0) {
      const double off = std::acos(std::clamp(-v.y(), -1.0, 1.0));
      p += cornea_mm * std::exp(-std::pow(off / 0.35, 2)) * v;
    }
  return mesh;
}

/// A mesh about the left eye and a copy of another one about the right eye.
inline TriMesh about_both_eyes(TriMesh left, const TriMesh& right) {
  const int first = static_cast<int>(left.vertices.size());
  for (const auto& p : right.vertices)
    left.vertices.push_back(p - Eigen::Vector3d(2 * eye_centre.x(), 0, 0));
  for (const auto& t : right.triangles)
    left.triangles.emplace_back(t[0] + first, t[1] + first, t[2] + first);
  return left;
}

}  // namespace condyle
